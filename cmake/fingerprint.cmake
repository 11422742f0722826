# Digests that identify what produced a number: of solvers, layers and other parts of the program, over sources, compiler,
# flags and libraries. During the build a small program (cmake/fingerprint.cpp) finds the files of each solver and part in the
# sources; no list names them.
#   taut_write_fingerprint(OUT LAYERS FOLDER|... ... PARTS NAME=FOLDER|... ...)
function(taut_write_fingerprint out)
  get_target_property(options taut_flags INTERFACE_COMPILE_OPTIONS)
  list(FILTER options EXCLUDE REGEX "^-W|ggc-|^-fvisibility")  # these change no result
  list(JOIN options " " options)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(REGEX REPLACE " -g[0-9]*" "" of_type "${CMAKE_CXX_FLAGS_${type}}")
  string(CONCAT tools "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR}; "
         "flags ${CMAKE_CXX_FLAGS} ${of_type} ${options}; "
         "Eigen ${Eigen3_VERSION}; Bullet ${BULLET64_VERSION}")
  cmake_parse_arguments(of "" "" "LAYERS;PARTS" ${ARGN})
  string(REGEX REPLACE "[^=;|]+=" "" folders "${of_LAYERS};${of_PARTS}")
  string(REPLACE "|" ";" folders "${folders}")
  # A part may include files from anywhere in core and experiments.
  file(GLOB_RECURSE read CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/core/*.[ch]pp ${PROJECT_SOURCE_DIR}/experiments/*.[ch]pp)
  foreach(folder IN LISTS folders)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}.[ch]pp ${PROJECT_SOURCE_DIR}/${folder}/*)
    list(APPEND read ${found})
  endforeach()
  list(REMOVE_DUPLICATES read)
  add_executable(taut_fingerprint_writer ${PROJECT_SOURCE_DIR}/cmake/fingerprint.cpp)
  target_compile_features(taut_fingerprint_writer PRIVATE cxx_std_20)
  target_link_libraries(taut_fingerprint_writer PRIVATE OpenSSL::Crypto)
  add_custom_command(OUTPUT ${out} DEPENDS ${read} taut_fingerprint_writer VERBATIM
                     COMMAND taut_fingerprint_writer ${out} ${PROJECT_SOURCE_DIR} "${tools}" ${of_LAYERS} -- ${of_PARTS})
endfunction()
