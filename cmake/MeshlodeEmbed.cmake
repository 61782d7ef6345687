# SPDX-License-Identifier: GPL-3.0-or-later
# meshlode_embed(TARGET FILE...): each FILE's bytes as NAME.inc (EmbedBytes.cmake), where TARGET's sources find them.
function(meshlode_embed target)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/embedded")
  set(outputs)
  foreach(file IN LISTS ARGN)
    get_filename_component(name "${file}" NAME)
    add_custom_command(OUTPUT "${folder}/${name}.inc"
      COMMAND ${CMAKE_COMMAND} -DINPUT=${file} -DOUTPUT=${folder}/${name}.inc -P ${PROJECT_SOURCE_DIR}/cmake/EmbedBytes.cmake
      DEPENDS "${file}" ${PROJECT_SOURCE_DIR}/cmake/EmbedBytes.cmake VERBATIM)
    list(APPEND outputs "${folder}/${name}.inc")
  endforeach()
  add_custom_target(${target}_embedded DEPENDS ${outputs})
  add_dependencies(${target} ${target}_embedded)
  target_include_directories(${target} PRIVATE "${folder}")
endfunction()
