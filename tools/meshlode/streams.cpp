// SPDX-License-Identifier: GPL-3.0-or-later
#include "streams.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include <unistd.h>

#include "base/try.h"
#include "output_name.h"
#include "outputs.h"

namespace meshlode::cli {

namespace {

constexpr const char* kStdin = "stdin";

Error stdin_error(const char* what) {
  return {ErrorCode::kIo, kStdin, std::string(what) + ": " + std::strerror(errno)};
}

}  // namespace

Result<std::string> input_path(const std::string& word) {
  if (word != kStream) return word;
  static std::FILE* file = nullptr;  // closed by the end of the process
  if (file != nullptr) return Error{ErrorCode::kUsage, kStdin, "given more than once"};
  file = std::tmpfile();
  if (file == nullptr) return stdin_error("cannot make a temporary file");
  std::vector<char> block(1U << 20U);
  while (true) {
    const ssize_t count = ::read(STDIN_FILENO, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return stdin_error("cannot read");
    if (count == 0) break;
    const auto size = static_cast<std::size_t>(count);
    if (std::fwrite(block.data(), 1, size, file) != size) return stdin_error("cannot keep it in a temporary file");
  }
  if (std::fflush(file) != 0) return stdin_error("cannot keep it in a temporary file");
  std::string path = "/dev/fd/" + std::to_string(::fileno(file));
  rename_in_errors(path, kStdin);
  return path;
}

std::string input_name(const std::string& word) {
  return word == kStream ? kStdin : word;
}

Status claim_output(const std::string& path) {
  return path == kStream ? Status(Ok{}) : output_files().claim(path);
}

Status write_output(const std::string& path, std::span<const std::uint8_t> bytes) {
  if (path != kStream) return output_files().write(path, bytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return write_stdout(text);
}

Status write_output(const std::string& path, const std::string& text) {
  return write_output(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

bool print_beside(const std::string& output, const std::string& text) {
  if (output != kStream) return print_out(text);
  std::fputs(text.c_str(), stderr);
  return true;
}

void add_report_option(OptionParser& parser, std::string& path) {
  parser.add_value("-o,--output FILE", path, "file to write instead of stdout, which is -");
}

Status claim_report(const std::string& path, std::initializer_list<std::string_view> formats) {
  if (path == kStream) return Ok{};
  TRY(check_text_name("-o", path, formats));
  return claim_output(path);
}

}  // namespace meshlode::cli
