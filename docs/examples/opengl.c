/* SPDX-License-Identifier: MIT */
/* A cut of an asset drawn by OpenGL 4.3 core, without a window (EGL): pages go to the GPU as they are, and the vertex
 * shader decodes them with <meshlode/decode.glsl>. C99.
 *
 *   opengl ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z
 *
 * Bindings: storage buffer 0 the pages' words, 1 the items, 2 the instances, 3 the meshes (the structs below). */
#define EGL_EGLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <string.h>

#include <meshlode/meshlode.h>

#include "place.h"
#include "write_png.h"

#ifndef DECODE_GLSL /* where <meshlode/decode.glsl> is installed */
#define DECODE_GLSL "/usr/include/meshlode/decode.glsl"
#endif

/* What the shader sees of the tables, std430. */
typedef struct gpu_item {
  uint32_t instance, page_word, index_in_page, cluster;
} gpu_item;
typedef struct gpu_instance {
  gpu_place place;
  uint32_t mesh, unused[3];
} gpu_instance;

static meshlode_asset* asset;
static meshlode_error error;

/* 1. A context without a window. */
static void open_context(void) {
  static const EGLint config_words[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  static const EGLint context_words[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  EGLConfig config;
  EGLContext context;
  EGLint count = 0;
  if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY); /* a driver that is not Mesa's */
  if (!eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API) ||
      !eglChooseConfig(display, config_words, &config, 1, &count) || count == 0)
    stop("EGL", "no display with OpenGL");
  context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_words);
  if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
    stop("EGL", "no OpenGL 4.3 without a window");
}

/* 2. The shaders. decode.glsl is pasted behind the buffer that it reads. */
static const char* const vertex_head =
    "#version 430 core\n"
    "struct Instance { mat4 clip; vec4 normal[3]; uint mesh; uint unused[3]; };\n"
    "layout(std430, binding = 0) readonly buffer Pages { uint words[]; };\n"
    "layout(std430, binding = 1) readonly buffer Items { uvec4 items[]; };\n"
    "layout(std430, binding = 2) readonly buffer Instances { Instance instances[]; };\n"
    "layout(std430, binding = 3) readonly buffer Meshes { uvec4 meshes[]; };\n"
    "#define LODE_WORD(i) words[i]\n";
static const char* const vertex_main =
    "out vec3 normal;\n"
    "flat out uint cluster;\n"
    "void main() {\n"
    "  uvec4 item = items[gl_InstanceID];\n"
    "  uvec4 m = meshes[instances[item.x].mesh];\n"
    "  LodeCluster c = lode_read_cluster(LodeMesh(m.x, m.y, m.z, m.w), item.y, item.z);\n"
    "  uint triangle = uint(gl_VertexID) / 3u;\n"
    "  cluster = item.w;\n"
    "  normal = vec3(0.0);\n"
    "  gl_Position = vec4(0.0);\n"
    "  if (triangle >= c.triangle_count) return;\n" /* all three corners: nothing is drawn */
    "  uint v = lode_triangle(c, triangle)[gl_VertexID % 3];\n"
    "  gl_Position = instances[item.x].clip * vec4(lode_position(c, lode_raw_position(c, v)), 1.0);\n"
    "  if (m.x == 0u) return;\n"
    "  vec3 n = vec3(lode_normal(c, v));\n"
    "  for (int k = 0; k < 3; ++k) normal[k] = dot(instances[item.x].normal[k].xyz, n);\n"
    "}\n";
static const char* const fragment =
    "#version 430 core\n"
    "in vec3 normal;\n"
    "flat in uint cluster;\n"
    "out vec4 color;\n"
    "void main() {\n"
    "  vec3 hue = vec3((uvec3(cluster) * uvec3(37u, 61u, 85u)) % 160u + 96u) / 255.0;\n"
    "  float light = normal == vec3(0.0) ? 1.0 : 0.55 + 0.45 * dot(normalize(normal), normalize(vec3(0.4, 0.8, "
    "0.5)));\n"
    "  color = vec4(max(hue * light, vec3(0.15)), 1.0);\n" /* lighter than the background */
    "}\n";

static char* read_text(const char* path) {
  FILE* in = fopen(path, "rb");
  char* text = take(1 << 20, 1);
  if (!in || fread(text, 1, 1 << 20, in) == 0) stop(path, "cannot be read");
  fclose(in);
  return text;
}
static void add_shader(GLuint program, GLenum kind, int count, const char* const* texts) {
  const GLuint shader = glCreateShader(kind);
  char log[2048] = "";
  GLint is_compiled = 0;
  glShaderSource(shader, count, texts, NULL);
  glCompileShader(shader);
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
  glGetShaderInfoLog(shader, sizeof log, NULL, log);
  if (!is_compiled) stop("shader", log);
  glAttachShader(program, shader);
}
static void use_program(void) {
  const char* texts[3];
  const GLuint program = glCreateProgram();
  char log[2048] = "";
  GLint is_linked = 0;
  texts[0] = vertex_head;
  texts[1] = read_text(DECODE_GLSL);
  texts[2] = vertex_main;
  add_shader(program, GL_VERTEX_SHADER, 3, texts);
  add_shader(program, GL_FRAGMENT_SHADER, 1, &fragment);
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
  glGetProgramInfoLog(program, sizeof log, NULL, log);
  if (!is_linked) stop("program", log);
  glUseProgram(program);
}

/* 3. What a camera needs. */
static meshlode_draw_item* select_items(const meshlode_view* view, const double target[3], double pixel_error,
                                        size_t* count) {
  static const double up[3] = {0.0, 1.0, 0.0};
  meshlode_frustum frustum;
  meshlode_draw_item* items;
  if (meshlode_make_frustum(view, target, up, (double)WIDTH / HEIGHT, &frustum, &error)) stop("view", error.text);
  if (meshlode_select_frustum(asset, view, &frustum, pixel_error, NULL, 0, count, &error) == MESHLODE_USAGE)
    stop("view", error.text);
  items = take(*count, sizeof *items);
  if (meshlode_select_frustum(asset, view, &frustum, pixel_error, items, *count, count, &error))
    stop("view", error.text);
  return items;
}

/* 4. Pages, each once, one behind the other: decoded they are what the shader reads. */
static uint32_t* load_pages(const meshlode_draw_item* items, size_t count, uint32_t** words, size_t* word_count) {
  uint32_t page_count, p;
  const meshlode_page* pages = meshlode_pages(asset, &page_count);
  uint32_t* first_word = take(page_count, sizeof *first_word); /* 1 more than it is; 0: not loaded */
  size_t i, bytes = 0;
  GLint64 most = 0;
  for (i = 0; i < count; ++i) {
    p = meshlode_page_of(asset, items[i].cluster);
    if (!first_word[p]) bytes += pages[p].bytes;
    first_word[p] = 1;
  }
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (bytes > (size_t)most) stop("pages", "more than a storage buffer holds: take a larger error");
  *words = take(bytes / 4, 4);
  *word_count = 0;
  for (p = 0; p < page_count; ++p) {
    if (!first_word[p]) continue;
    if (meshlode_load_page(asset, p, *words + *word_count, pages[p].bytes, &error)) stop("page", error.text);
    first_word[p] = (uint32_t)*word_count + 1;
    *word_count += pages[p].bytes / 4;
  }
  return first_word;
}

/* 5. Tables, with the transforms of place.h. */
static void upload(GLuint binding, const void* data, size_t bytes) {
  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
  glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)(bytes ? bytes : 4), bytes ? data : NULL, GL_STATIC_DRAW);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
}
static void upload_tables(const double eye[3], const double axes[3][3]) {
  uint32_t instance_count, mesh_count, i;
  const meshlode_instance* instances = meshlode_instances(asset, &instance_count);
  const meshlode_mesh* meshes = meshlode_meshes(asset, &mesh_count);
  gpu_instance* placed = take(instance_count, sizeof *placed);
  gpu_mesh* described = take(mesh_count, sizeof *described);
  for (i = 0; i < instance_count; ++i) {
    placed[i].place = place_instance(&instances[i], &meshes[instances[i].mesh], eye, axes, 1.0, -1.0);
    placed[i].mesh = instances[i].mesh;
  }
  for (i = 0; i < mesh_count; ++i) described[i] = describe_mesh(&meshes[i]);
  upload(2, placed, instance_count * sizeof *placed);
  upload(3, described, mesh_count * sizeof *described);
  free(placed);
  free(described);
}

/* 6. A picture to draw to. */
static void open_picture(void) {
  GLuint frame, buffers[2];
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glGenRenderbuffers(2, buffers);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, WIDTH, HEIGHT);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, WIDTH, HEIGHT);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) stop("picture", "cannot be drawn to");
  glViewport(0, 0, WIDTH, HEIGHT);
  glEnable(GL_DEPTH_TEST);
  glClearColor(32 / 255.0f, 32 / 255.0f, 32 / 255.0f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}
static void save_picture(const char* path, double* covered) {
  static unsigned char below[HEIGHT][WIDTH][3], picture[HEIGHT][WIDTH][3]; /* OpenGL's first row is the lowest */
  size_t y, x, count = 0;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, below);
  for (y = 0; y < HEIGHT; ++y) {
    memcpy(picture[y], below[HEIGHT - 1 - y], sizeof picture[y]);
    for (x = 0; x < WIDTH; ++x) count += picture[y][x][0] != 32 || picture[y][x][1] != 32 || picture[y][x][2] != 32;
  }
  *covered = 100.0 * (double)count / (WIDTH * HEIGHT);
  if (write_png(path, &picture[0][0][0], WIDTH, HEIGHT)) stop(path, "cannot be written, or is no PNG");
}

int main(int argc, char** argv) {
  meshlode_view view = {{0.0, 0.0, 0.0}, 0, FOVY, 0.0, NEAR, HEIGHT, MESHLODE_PROMISE_POSITION};
  double target[3], axes[3][3], covered;
  meshlode_draw_item* items;
  gpu_item* uploaded;
  uint32_t *words, *first_word, cluster_count, page_count;
  size_t count, word_count, i, triangles = 0;
  const meshlode_cluster* clusters;
  const meshlode_page* pages;
  if (argc != 10) stop("usage", "opengl ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z");
  if (meshlode_open_file(argv[1], &asset, &error)) stop(argv[1], error.text);
  look(argv + 4, view.eye, target, axes);

  open_context();
  use_program();
  items = select_items(&view, target, atof(argv[3]), &count);
  first_word = load_pages(items, count, &words, &word_count);
  clusters = meshlode_clusters(asset, &cluster_count);
  pages = meshlode_pages(asset, &page_count);
  uploaded = take(count, sizeof *uploaded);
  for (i = 0; i < count; ++i) {
    const uint32_t cluster = items[i].cluster, page = meshlode_page_of(asset, cluster);
    const gpu_item one = {items[i].instance, first_word[page] - 1, cluster - pages[page].first_cluster, cluster};
    uploaded[i] = one;
    triangles += clusters[cluster].triangles_less_1 + 1u;
  }
  upload(0, words, word_count * 4);
  upload(1, uploaded, count * sizeof *uploaded);
  upload_tables(view.eye, (const double(*)[3])axes);
  open_picture();
  {
    GLuint nothing; /* core profiles want an array, though nothing comes from it */
    glGenVertexArrays(1, &nothing);
    glBindVertexArray(nothing);
  }
  glDrawArraysInstanced(GL_TRIANGLES, 0, 3 * MESHLODE_MAX_CLUSTER_TRIANGLES, (GLsizei)count);
  save_picture(argv[2], &covered);
  if (glGetError() != GL_NO_ERROR) stop("OpenGL", "an error");
  printf("%s: %u triangles in %u clusters, %.2f%% of the picture covered\n", (const char*)glGetString(GL_RENDERER),
         (unsigned)triangles, (unsigned)count, covered);
  free(uploaded);
  free(words);
  free(first_word);
  free(items);
  meshlode_close(asset);
  return 0;
}
