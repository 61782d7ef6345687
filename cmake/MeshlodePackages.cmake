# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages of what MeshlodeInstall.cmake installs: `cpack` in the build folder (docs/guides/packages.md). Needs file and
# dpkg-shlibdeps, which find out on what the binaries depend.
#   libmeshlode0     MIT: libmeshlode.so.0, for C
#   libmeshlode-dev  headers, the static runtime, what find_package(meshlode) reads
#   meshlode         GPL: the program, its man pages and completion scripts, libmeshlode_build.so.0, schemas
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME meshlode)
set(CPACK_PACKAGE_VENDOR meshlode)
set(MESHLODE_PACKAGE_CONTACT "nobody in particular <nobody@localhost>" CACHE STRING
    "The maintainer that Debian packages name: who distributes them")
set(CPACK_PACKAGE_CONTACT "${MESHLODE_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS  # whatever the umask of who packs
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSES/GPL-3.0-or-later.txt")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)  # a package for each component
set(CPACK_COMPONENTS_ALL runtime dev tools)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)  # exactly this version: there is no stable ABI yet
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libmeshlode${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "The shared library that opens assets, selects cuts and decodes clusters, for C.")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME meshlode)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "libvulkan1, mesa-vulkan-drivers")  # opened at run time, for --gpu
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The command line, and the shared library of the builder.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libmeshlode-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DEV_DEPENDS runtime tools)  # find_package() names all that is installed
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers, the static runtime library, and what CMake's find_package() reads.")
set(meshlode_dev_depends)  # of the static library, which leaves its codecs to the linker
foreach(codec IN LISTS meshlode_runtime_codecs)
  list(APPEND meshlode_dev_depends lib${codec}-dev)
endforeach()
list(JOIN meshlode_dev_depends ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)

# Debian wants each package's licence where its name is; an installation without packages has its own (MeshlodeInstall).
foreach(component IN ITEMS runtime dev tools)
  string(TOUPPER ${component} name)
  install(FILES cmake/copyright DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_DEBIAN_${name}_PACKAGE_NAME}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
