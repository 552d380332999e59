# What `cmake --install` and the packages hold beside the programs: the library
# for find_package(hpm_mvs), and the documents. Component `runtime` is for users,
# `development` for programs that link the library.
include_guard()
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/hpm_mvs)
install(EXPORT hpm_mvs-targets NAMESPACE hpm_mvs:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(cmake/hpm_mvs-config.cmake.in hpm_mvs-config.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(hpm_mvs-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/hpm_mvs-config.cmake
  ${PROJECT_BINARY_DIR}/hpm_mvs-config-version.cmake
  cmake/hpm_opencv.cmake
  DESTINATION ${package_folder} COMPONENT development)
if(NOT WIN32)
  set(other_systems PATTERN "*_windows.h" EXCLUDE)
endif()
install(DIRECTORY src colmap_plugin DESTINATION include/hpm_mvs COMPONENT development
  FILES_MATCHING PATTERN "*.h"
  PATTERN in_colmap EXCLUDE PATTERN wrapper EXCLUDE PATTERN "*-inl.h" EXCLUDE ${other_systems})
# Of cuda/, how the backend is made; what lies below it needs the CUDA toolkit.
install(FILES cuda/cuda_backend.h cuda/cuda_devices.h
        DESTINATION include/hpm_mvs/cuda COMPONENT development)

install(FILES README.md CHANGELOG.md docs/options.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
if(HPM_CGAL)
  set(HPM_CGAL_NOTE "
The sources are under the licence below. This build holds code of CGAL's 2D
triangulations, which are under the GNU General Public License, version 3 or later, so
the programs may be passed on only under its terms; on Debian systems its text is in
/usr/share/common-licenses/GPL-3. A build with -DHPM_CGAL=OFF holds none of it.
")
endif()
file(READ LICENSE HPM_LICENSE)
configure_file(cmake/package/copyright.in copyright @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
