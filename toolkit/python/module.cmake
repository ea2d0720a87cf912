# SPDX-License-Identifier: Apache-2.0
# What the modules of the package cinch need, and how they are made.
function(cinch_has_numpy python out)
  execute_process(COMMAND ${python} -c "import numpy, os, sysconfig; \
assert os.path.exists(os.path.join(sysconfig.get_path('include'), 'Python.h'))"
    RESULT_VARIABLE fault OUTPUT_QUIET ERROR_QUIET)
  if(fault EQUAL 0)
    set(${out} TRUE PARENT_SCOPE)
  else()
    set(${out} FALSE PARENT_SCOPE)
  endif()
endfunction()
if(NOT CINCH_PYTHON_EXECUTABLE) # Debian's NumPy is of Debian's interpreter, which need not be the first
  find_program(first_python python3 NO_CACHE)
  foreach(candidate ${first_python} /usr/bin/python3)
    cinch_has_numpy(${candidate} fits)
    if(fits)
      set(CINCH_PYTHON_EXECUTABLE ${candidate} CACHE FILEPATH "Interpreter, with NumPy, for which cinch is built")
      break()
    endif()
  endforeach()
endif()
cinch_has_numpy("${CINCH_PYTHON_EXECUTABLE}" fits)
if(NOT fits)
  message(FATAL_ERROR "CINCH_PYTHON: no python3 with NumPy and Python.h (python3-numpy, python3-dev)")
endif()
set(Python_EXECUTABLE ${CINCH_PYTHON_EXECUTABLE})
find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 REQUIRED)

set(CINCH_PYTHON_FOLDER ${PROJECT_BINARY_DIR}/python)

# A module of the package cinch, NAME.so in its folder.
function(cinch_python_module target name folder)
  pybind11_add_module(${target} MODULE NO_EXTRAS ${ARGN})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${CINCH_PYTHON_FOLDER}/cinch/${folder}
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_link_libraries(${target} PRIVATE cinch_flags)
  # What is linked statically stays its own: two modules of one process share nothing but Python's objects.
  target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections)
endfunction()

# The files of the package, in the build folder as they stand.
function(cinch_python_files target from)
  foreach(file IN LISTS ARGN)
    set(to ${CINCH_PYTHON_FOLDER}/${file})
    add_custom_command(OUTPUT ${to} DEPENDS ${from}/${file}
      COMMAND ${CMAKE_COMMAND} -E copy ${from}/${file} ${to} VERBATIM)
    list(APPEND copies ${to})
  endforeach()
  add_custom_target(${target}_files DEPENDS ${copies})
  add_dependencies(${target} ${target}_files)
endfunction()
