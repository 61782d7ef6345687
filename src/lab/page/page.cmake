# SPDX-License-Identifier: GPL-3.0-or-later
# meshlode_page_sources: this room's files. Its style sheets and its script are files of their own, which the program has in
# itself.
foreach(part page_css=style.css plot_css=plot.css page_script=script.js)
  string(REGEX MATCH "^(.*)=(.*)$" part "${part}")
  set(file "${CMAKE_CURRENT_LIST_DIR}/${CMAKE_MATCH_2}")
  file(READ "${file}" meshlode_${CMAKE_MATCH_1})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
endforeach()
set(embedded "${CMAKE_CURRENT_BINARY_DIR}/page/embedded.cpp")
configure_file("${CMAKE_CURRENT_LIST_DIR}/embedded.cpp.in" "${embedded}" @ONLY)
set(meshlode_page_sources
    page/axis.cpp page/charts.cpp page/markup.cpp page/numbers.cpp page/page.cpp page/parts.cpp page/summary.cpp page/palette.cpp page/pictures.cpp
    page/plot.cpp page/read_pictures.cpp page/table.cpp page/tables.cpp page/treemap.cpp "${embedded}")
