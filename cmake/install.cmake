# Files that `cmake --install` installs: the program with its data, and the library. `cpack -G DEB` makes a package of each.
include(CMakePackageConfigHelpers)

install(TARGETS taut taut-f32 COMPONENT program)
# ./taut builds only the programs.
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${PROJECT_BINARY_DIR}\" --target taut_manual
                              OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)
              if(failed)
                message(FATAL_ERROR \"The manual could not be made: \${said}\")
              endif()" COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/taut.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/taut.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME taut COMPONENT program)
install(FILES experiments/main-job.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/taut COMPONENT program)
install(DIRECTORY experiments/external/sdk
        DESTINATION ${CMAKE_INSTALL_DATADIR}/taut/external COMPONENT program)
install(DIRECTORY experiments/scenes experiments/studies experiments/templates experiments/beside results/references
        DESTINATION ${CMAKE_INSTALL_DATADIR}/taut COMPONENT program)

# The Python package; its data are the program's.
if(TAUT_PYTHON)
  set(python_package lib/python3/dist-packages/taut)
  install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${PROJECT_BINARY_DIR}\" --target taut_python
                                OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)
                if(failed)
                  message(FATAL_ERROR \"The Python module could not be built: \${said}\")
                endif()" COMPONENT python)
  install(TARGETS taut_python LIBRARY DESTINATION ${python_package} COMPONENT python)
  install(FILES ${taut_python_FILES} DESTINATION ${python_package} COMPONENT python)
  install(CODE "file(CREATE_LINK ../../../../${CMAKE_INSTALL_DATADIR}/taut
                     \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${python_package}/data\" SYMBOLIC)" COMPONENT python)
endif()

# The library: taut::model, taut::io, taut::solver, taut::reference, taut::predict, taut::metrics, taut::case and what they need.
set(libraries case predict metrics reference system io solver model fingerprint)
foreach(library IN LISTS libraries)
  set_target_properties(taut_${library} PROPERTIES EXPORT_NAME ${library})
  target_include_directories(taut_${library} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS taut_${library} EXPORT taut COMPONENT development)
endforeach()
# Two cycles, which CMake puts on the link line: find_solver() calls solvers(), and a metric calls known_references().
target_link_libraries(taut_model INTERFACE $<INSTALL_INTERFACE:taut::solver>)
target_link_libraries(taut_metrics INTERFACE $<INSTALL_INTERFACE:taut::case>)

# core/model/scene.hpp becomes <taut/model/scene.hpp>, also where headers include each other.
set(headers core/io/drawn_scene.hpp core/io/mesh_io.hpp core/io/positions/positions.hpp core/io/scene_io.hpp experiments/system/data.hpp
            core/reference/resting_springs.hpp core/reference/strain_at_rest.hpp experiments/predict/prediction.hpp
            experiments/metrics/metric.hpp experiments/case/case.hpp experiments/case/computed_motion.hpp
            experiments/case/digest.hpp experiments/case/record.hpp experiments/case/record_io.hpp
            experiments/case/run_case.hpp experiments/case/trajectory.hpp
            core/reference/fit.hpp experiments/answer/answer.hpp experiments/answer/number.hpp
            experiments/truths/assertions/assertions.hpp experiments/truths/assertions/judged.hpp
            experiments/truths/suite.hpp experiments/truths/truth.hpp experiments/truths/verification.hpp)
file(GLOB model CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} core/model/*.hpp)
install(CODE "
  file(REMOVE_RECURSE \"${PROJECT_BINARY_DIR}/include/taut\")  # may have files under old names
  foreach(header IN ITEMS ${model} ${headers})
    file(READ \"${PROJECT_SOURCE_DIR}/\${header}\" text)
    string(REGEX REPLACE \"(#include \\\")(core|experiments)/\" \"\\\\1taut/\" text \"\${text}\")
    string(REGEX REPLACE \"^(core|experiments)/\" \"\" header \"\${header}\")
    file(WRITE \"${PROJECT_BINARY_DIR}/include/taut/\${header}\" \"\${text}\")
  endforeach()" COMPONENT development)
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/taut DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/taut)
set(templates ${PROJECT_SOURCE_DIR}/cmake/package)
configure_package_config_file(${templates}/taut-config.cmake.in taut-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(taut-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/taut-config.cmake ${PROJECT_BINARY_DIR}/taut-config-version.cmake
        DESTINATION ${package} COMPONENT development)
install(EXPORT taut NAMESPACE taut:: FILE taut-targets.cmake DESTINATION ${package} COMPONENT development)

# taut.pc finds its own folder, so that an installation may be moved; absolute paths of libraries or headers are kept.
file(RELATIVE_PATH to_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
cmake_path(APPEND pc_libdir "\${prefix}" ${CMAKE_INSTALL_LIBDIR})
cmake_path(APPEND pc_includedir "\${prefix}" ${CMAKE_INSTALL_INCLUDEDIR})
list(TRANSFORM libraries PREPEND "-ltaut_" OUTPUT_VARIABLE pc_libraries)
list(JOIN pc_libraries " " pc_libraries)
configure_file(cmake/package/taut.pc.in taut.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/taut.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

set(CPACK_PACKAGE_CONTACT "The taut developers")
set(CPACK_COMPONENTS_ALL program development)
if(TAUT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_LICENSE MIT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME taut)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "testbed for cloth solvers
 Runs cloth solvers side by side on identical scenes and says what each
 costs, how far it is off and when it breaks.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libosmesa6, gnuplot-nox, fonts-dejavu-core, ffmpeg")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-taut)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "testbed for cloth solvers, from Python
 Scenes, runs as NumPy arrays, scores of arrays of other programs, results
 as a pandas.DataFrame and solvers written in Python.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
string(CONCAT CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "taut (= ${PROJECT_VERSION}), python3-numpy, "
       "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtaut-dev)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "testbed for cloth solvers, library
 Scenes, solvers, metrics and the run of one case, to be called from a
 program of one's own.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libtomlplusplus-dev, libssl-dev")
include(CPack)
