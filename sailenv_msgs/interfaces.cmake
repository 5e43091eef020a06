# Included by the project of a package: generates what lies in its folders msg/, srv/ and action/.
# Takes the packages whose types they use from the list `dependencies`.

find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
foreach(dependency IN LISTS dependencies)
  find_package(${dependency} REQUIRED)
endforeach()

# Relative paths, because rosidl derives each interface's name from its path.
file(GLOB interfaces RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}" CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/msg/*.msg" "${CMAKE_CURRENT_SOURCE_DIR}/srv/*.srv"
  "${CMAKE_CURRENT_SOURCE_DIR}/action/*.action")
if(PYTHON_ONLY)
  list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "_cpp:")
  # Generated conversions: their compiling counts here, not their speed.
  string(REPLACE "-O3" "-O1" CMAKE_C_FLAGS_RELEASE "${CMAKE_C_FLAGS_RELEASE}")
  string(REPLACE "-O3" "-O1" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
endif()
# All generators parse the same interfaces; the first one's work is kept for the others.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set_property(GLOBAL PROPERTY RULE_LAUNCH_CUSTOM
  "\"${Python3_EXECUTABLE}\" \"${CMAKE_CURRENT_LIST_DIR}/parse_once.py\" \"${CMAKE_BINARY_DIR}/parsed\"")
rosidl_generate_interfaces(${PROJECT_NAME} ${interfaces} DEPENDENCIES ${dependencies})

# Two thirds of the time to compile these sources went into reading the same headers.
foreach(language IN ITEMS c cpp)
  set(target ${PROJECT_NAME}__rosidl_typesupport_fastrtps_${language})
  if(TARGET ${target})
    target_precompile_headers(${target} PRIVATE
      <cassert> <cstddef> <limits> <string> <vector>
      <fastcdr/Cdr.h>
      <rosidl_typesupport_fastrtps_cpp/identifier.hpp>
      <rosidl_typesupport_fastrtps_cpp/message_type_support.h>)
  endif()
endforeach()
target_precompile_headers(${PROJECT_NAME}__rosidl_generator_py PRIVATE <Python.h> <stdbool.h>)

# Many small generated files that read the same headers: they are compiled some at a time. Not those
# that define names of their file alone, and not messages that others may hold, in C++, where a
# template may not be specialised after it was used.
foreach(target IN ITEMS
    rosidl_generator_c rosidl_typesupport_c rosidl_typesupport_cpp
    rosidl_typesupport_introspection_c rosidl_typesupport_introspection_cpp
    rosidl_typesupport_fastrtps_c rosidl_typesupport_fastrtps_cpp rosidl_generator_py)
  set(target ${PROJECT_NAME}__${target})
  if(TARGET ${target})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "__description\\.c$|/msg/.*\\.cpp$")
    set_source_files_properties(${sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endforeach()

# The ROS 2 wheels export include directories of the machine that they were built on, and CMake
# refuses to generate while one of them is missing. An installation whose directories are all
# there is left as it is.
if(NOT CMAKE_VERSION VERSION_LESS 3.21)
  get_directory_property(targets IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(directories)
      set(present ${directories})
      foreach(directory IN LISTS directories)
        if(IS_ABSOLUTE "${directory}" AND NOT EXISTS "${directory}")
          list(REMOVE_ITEM present "${directory}")
        endif()
      endforeach()
      set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${present}")
    endif()
  endforeach()
endif()

ament_export_dependencies(rosidl_default_runtime)
ament_package()
