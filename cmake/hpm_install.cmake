# What `cmake --install` and the Debian package hold beside the programs: the library
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
install(DIRECTORY src colmap_plugin DESTINATION include/hpm_mvs COMPONENT development
  FILES_MATCHING PATTERN "*.h" PATTERN in_colmap EXCLUDE PATTERN wrapper EXCLUDE)
# Of cuda/, the backend's interface with all that it includes; no more, for what lies
# below it needs the CUDA toolkit.
install(DIRECTORY cuda DESTINATION include/hpm_mvs COMPONENT development
  FILES_MATCHING REGEX "/(cuda_backend|cuda_devices|device_problem|fast_math|memory_estimate|samplers)\\.h$")

install(FILES README.md CHANGELOG.md docs/options.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)

# `cpack -G DEB` in the build folder makes hpm-mvs_<version>_<architecture>.deb of the
# programs alone.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hpm-mvs)
set(CPACK_PACKAGE_CONTACT "HPM-MVS maintainers <hpm-mvs@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS colmap)
set(CPACK_PACKAGE_DESCRIPTION "hpm_mvs computes the depth and normal maps of a COLMAP dense workspace: the same
options, the same files in, the same files out, and no GPU needed.")
if(HPM_CGAL)
  string(APPEND CPACK_PACKAGE_DESCRIPTION "
This build triangulates with CGAL, so the package may be passed on only under the GPL.")
endif()
include(CPack)
