# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(meshlode): the libraries and the program as targets, and functions for what is built with the program.
include("${CMAKE_CURRENT_LIST_DIR}/meshlodeTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/MeshlodeAssets.cmake")
