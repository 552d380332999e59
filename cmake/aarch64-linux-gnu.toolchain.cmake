# Builds for 64-bit ARM on a Debian machine of another kind. The compiler and the
# emulator come from Debian, the libraries from a folder with Debian's arm64 packages;
# scripts/install_dependencies.sh --arm64 fetches all of them.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)  # notes on a change of GCC 10, in CGAL's headers

get_filename_component(HPM_ARM64_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/arm64-sysroot ABSOLUTE)
set(CMAKE_SYSROOT ${HPM_ARM64_SYSROOT})
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;${HPM_ARM64_SYSROOT})

# Headers and libraries never come from the machine that builds, programs always.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${HPM_ARM64_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
    ${HPM_ARM64_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${HPM_ARM64_SYSROOT}/usr/share/pkgconfig)
