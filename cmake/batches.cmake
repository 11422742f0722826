# Headers and templates dominate the cost of a build, so several files of a layer are compiled as one, with precompiled
# headers for what they include most. A file that differs from the last commit is compiled by itself, still with the
# precompiled headers, and the other batches stay as they are: the first edit of a file compiles the rest of its batch, too,
# and those that follow compile the file alone (tests/source/edits.py). `./taut` configures anew when other files differ.
set(TAUT_BATCH_SIZE 8 CACHE STRING "How many files of a layer are compiled as one (0: all)")

set(edited)
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} diff --name-only --no-renames HEAD -- *.cpp WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                  OUTPUT_VARIABLE edited OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(WRITE ${PROJECT_BINARY_DIR}/edited "${edited}")
string(REPLACE "\n" ";" TAUT_EDITED "${edited}")
list(TRANSFORM TAUT_EDITED PREPEND ${PROJECT_SOURCE_DIR}/)

# Compiles so many of the files that the target has now as one.
function(taut_compile_in_batches target size)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  set(batch 0)
  set(count 0)
  foreach(source IN LISTS sources)
    if(count EQUAL size AND NOT size EQUAL 0)
      math(EXPR batch "${batch} + 1")
      set(count 0)
    endif()
    math(EXPR count "${count} + 1")
    if(NOT source IN_LIST TAUT_EDITED)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP batch_${batch})
    endif()
  endforeach()
endfunction()
