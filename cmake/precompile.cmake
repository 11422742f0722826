# Headers that most files include anyway are compiled once for all targets that ask for it; they have to be compiled
# with the same options. A file still includes what it uses: -DTAUT_PRECOMPILE=OFF builds without, and shows what was
# forgotten.
#   taut_precompile(TARGET [BRIEF])
# BRIEF: the target is optimised for debugging (-Og). What waits for files, text and other processes gains nothing from
# more, and compiles in half the time.
option(TAUT_PRECOMPILE "Precompile the headers that most files include" ON)
set(taut_brief $<$<NOT:$<BOOL:${TAUT_SANITIZE}>>:-Og>)
if(TAUT_PRECOMPILE)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
  foreach(kind precompiled precompiled_brief)
    add_library(taut_${kind} OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
    target_link_libraries(taut_${kind} PRIVATE taut_flags Eigen3::Eigen)
    target_precompile_headers(taut_${kind} PRIVATE <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional>
                              <iomanip> <iostream> <map> <memory> <numbers> <optional> <set> <span>
                              <sstream> <string> <thread> <variant> <vector> <Eigen/Core> <Eigen/Geometry>)
    if(CCACHE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      target_compile_options(taut_${kind} PRIVATE -fpch-preprocess)  # ccache asks for it
    endif()
  endforeach()
  target_compile_options(taut_precompiled_brief PRIVATE ${taut_brief})
  target_precompile_headers(taut_precompiled_brief PRIVATE <nlohmann/json.hpp>)
endif()

function(taut_precompile target)
  set(kind precompiled)
  if(BRIEF IN_LIST ARGN)
    set(kind precompiled_brief)
    target_compile_options(${target} PRIVATE ${taut_brief})
  endif()
  if(TAUT_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM taut_${kind})
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      # g++ 12 forgets that a precompiled header was a system header: the "overflows" inside std::string (PR 105651).
      target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-restrict -Wno-array-bounds)
      if(CCACHE)
        target_compile_options(${target} PRIVATE -fpch-preprocess)
      endif()
    endif()
  endif()
endfunction()
