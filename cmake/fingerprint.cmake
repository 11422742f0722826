# What produced a number: digests of solvers, layers and of what measures, over sources, compiler, flags and libraries. A small
# program reads the sources while building (cmake/fingerprint.cpp): which files a solver consists of is listed nowhere.
#   taut_write_fingerprint(OUT LAYER=FOLDER|... ... measurement=FOLDER|...)
function(taut_write_fingerprint out)
  get_target_property(options taut_flags INTERFACE_COMPILE_OPTIONS)
  list(FILTER options EXCLUDE REGEX "^-W|ggc-|^-fvisibility")  # these change no result
  list(JOIN options " " options)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(CONCAT tools "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR}; "
         "flags ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} ${options}; "
         "Eigen ${Eigen3_VERSION}; Bullet ${BULLET64_VERSION}")
  string(REGEX REPLACE "[^=;|]+=" "" folders "${ARGN}")
  string(REPLACE "|" ";" folders "${folders}")
  set(read)
  foreach(folder IN LISTS folders)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}.[ch]pp ${PROJECT_SOURCE_DIR}/${folder}/*)
    list(APPEND read ${found})
  endforeach()
  list(REMOVE_DUPLICATES read)
  add_executable(taut_fingerprint_writer ${PROJECT_SOURCE_DIR}/cmake/fingerprint.cpp)
  target_compile_features(taut_fingerprint_writer PRIVATE cxx_std_20)
  target_link_libraries(taut_fingerprint_writer PRIVATE OpenSSL::Crypto)
  add_custom_command(OUTPUT ${out} DEPENDS ${read} taut_fingerprint_writer VERBATIM
                     COMMAND taut_fingerprint_writer ${out} ${PROJECT_SOURCE_DIR} "${tools}" ${ARGN})
endfunction()
