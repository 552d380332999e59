# `cpack -G DEB` in the build folder makes hpm-mvs_<version>-1~<system>_<architecture>.deb
# of the programs alone, for the system it is built on: that system's libraries are what
# it depends on. `cmake --build . --target source_archive` makes hpm_mvs-<version>.tar.xz.
include_guard()

include(${CMAKE_CURRENT_LIST_DIR}/hpm_system_name.cmake)
hpm_system_name(/etc/os-release system)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hpm-mvs)
set(CPACK_PACKAGE_CONTACT "HPM-MVS for COLMAP authors <hpm-mvs@users.noreply.example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime debian)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
if(system)
  string(APPEND CPACK_DEBIAN_PACKAGE_RELEASE "~${system}")
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS colmap)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "dense stereo for COLMAP workspaces by hierarchical prior mining")
set(CPACK_PACKAGE_DESCRIPTION "hpm_mvs computes the depth and normal maps of a COLMAP dense workspace: the
same options, the same files in, the same files out, and no GPU needed.")
if(HPM_CGAL)
  string(APPEND CPACK_PACKAGE_DESCRIPTION "
.
This build triangulates with CGAL, so the package may be passed on only
under the GPL.")
endif()

# Debian's own papers belong to the package alone.
set(papers ${PROJECT_BINARY_DIR}/package)
string(TIMESTAMP HPM_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(cmake/package/changelog.in ${papers}/changelog.Debian @ONLY)
configure_file(cmake/package/finish_deb.cmake.in ${papers}/finish_deb.cmake @ONLY)
install(FILES ${papers}/changelog.Debian DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT debian EXCLUDE_FROM_ALL)
set(CPACK_PRE_BUILD_SCRIPTS ${papers}/finish_deb.cmake)
include(CPack)

add_custom_target(source_archive
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/make_source_archive.sh ${PROJECT_BINARY_DIR}
  USES_TERMINAL)
