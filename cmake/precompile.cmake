# Headers that most files include anyway are compiled once for all targets that ask for it; they have to be compiled
# with the same options. A file still includes what it uses: -DTAUT_PRECOMPILE=OFF builds without, and shows what was
# forgotten.
#   taut_precompile(TARGET)
option(TAUT_PRECOMPILE "Precompile the headers that most files include" ON)
if(TAUT_PRECOMPILE)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
  add_library(taut_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(taut_precompiled PRIVATE taut_flags Eigen3::Eigen)
  target_precompile_headers(taut_precompiled PRIVATE <algorithm> <cmath> <functional> <iostream> <map> <memory>
                            <optional> <sstream> <string> <vector> <Eigen/Core> <Eigen/Geometry> <nlohmann/json.hpp>)
  if(CCACHE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(taut_precompiled PRIVATE -fpch-preprocess)  # ccache asks for it
  endif()
endif()

function(taut_precompile target)
  if(TAUT_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM taut_precompiled)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      # g++ 12 forgets that a precompiled header was a system header: the "overflows" inside std::string (PR 105651).
      target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-restrict -Wno-array-bounds)
      if(CCACHE)
        target_compile_options(${target} PRIVATE -fpch-preprocess)
      endif()
    endif()
  endif()
endfunction()
