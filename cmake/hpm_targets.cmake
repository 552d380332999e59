# The three kinds of targets of this project; every folder uses only these.
include_guard()

# Sanitizers make programs slower by so much, at most.
set(HPM_TIME_FACTOR 1)
if(HPM_SANITIZE)
  set(HPM_TIME_FACTOR 20)
endif()

# hpm_add_library(name SOURCES ... [DEPS ...] [PRIVATE_DEPS ...]): installed, outside of
# bench/ and tests/, as hpm_mvs::<name without hpm_>.
function(hpm_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/hpm_mvs>)
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:hpm_compile_options> ${ARG_DEPS}
                        PRIVATE ${ARG_PRIVATE_DEPS})
  file(RELATIVE_PATH module ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT module MATCHES "^(bench|tests)")
    string(REGEX REPLACE "^hpm_" "" export_name ${name})
    set_target_properties(${name} PROPERTIES EXPORT_NAME ${export_name})
    install(TARGETS ${name} EXPORT hpm_mvs-targets
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/hpm_mvs COMPONENT development)
  endif()
endfunction()

# hpm_add_executable(name SOURCES ... [DEPS ...])
function(hpm_add_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE hpm_compile_options ${ARG_DEPS})
endfunction()

# hpm_add_test(name SOURCES ... [DEPS ...] [LABELS ...] [TIMEOUT s]): one gtest program = one ctest test.
function(hpm_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE hpm_compile_options ${ARG_DEPS} GTest::gtest_main GTest::gmock)
  add_test(NAME ${name} COMMAND ${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * ${HPM_TIME_FACTOR}")
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()
