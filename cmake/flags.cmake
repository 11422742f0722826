# Compiler flags of all of taut's targets. Bit-identical results across compilers and SIMD widths rest on -ffp-contract=off;
# assertions stay alive, so NDEBUG is never defined.
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)  # one build serves the programs and the Python module
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
# Debug information makes a program of 11 MB one of 76 MB, which takes 2 s to link instead of 0.4 s.
set(CMAKE_CXX_FLAGS_RELEASE "-O2")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g")

find_program(CCACHE ccache)
if(CCACHE)
  # Without sloppiness, or without -fpch-preprocess below, ccache recompiles everything that uses a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

add_library(taut_flags INTERFACE)
target_compile_features(taut_flags INTERFACE cxx_std_20)
target_include_directories(taut_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(taut_flags INTERFACE
  -ffp-contract=off -fno-math-errno -fvisibility=hidden
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wnon-virtual-dtor -Woverloaded-virtual
  -Wno-missing-field-initializers)
# g++ collects garbage less often, which saves a tenth of the build time and costs a few hundred MB.
target_compile_options(taut_flags INTERFACE
  "$<$<CXX_COMPILER_ID:GNU>:SHELL:-fpch-preprocess --param ggc-min-expand=300 --param ggc-min-heapsize=1000000>")
if(TAUT_WERROR)
  target_compile_options(taut_flags INTERFACE -Werror)
endif()
if(TAUT_SANITIZE)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "TAUT_SANITIZE needs clang++: -DCMAKE_CXX_COMPILER=clang++")
  endif()
  set(CMAKE_CXX_FLAGS_RELEASE "-O1 -g1")  # their reports name lines
  target_compile_definitions(taut_flags INTERFACE TAUT_SANITIZED)
  # Leaves out checks of pointers that took two thirds of the compile time. The address sanitizer still detects accesses at null
  # and most accesses outside of an object, but none that lands in another object. Nothing detects a misaligned access, or a
  # wrong pointer that is never followed.
  target_compile_options(taut_flags INTERFACE
    -fsanitize=address,undefined,float-divide-by-zero -fno-sanitize=null,alignment,object-size,pointer-overflow
    -fno-sanitize-recover=all -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS)
  target_link_options(taut_flags INTERFACE -fsanitize=address,undefined)
endif()
