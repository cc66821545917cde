# Flags of our own targets, never of those that link us. UNCHECKED: not instrumented by the sanitizers;
# for the tests' own code, whose macros would take most of the time to compile.
function(vdb_madf_compiler_options target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "UNCHECKED" "" "")
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wno-psabi -ffp-contract=off)
  if(VDB_MADF_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(VDB_MADF_SANITIZE)
    target_compile_options(${target} PRIVATE -O1)
    if(NOT arg_UNCHECKED)
      target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=all
        -fno-omit-frame-pointer -g1)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND PROJECT_IS_TOP_LEVEL)
  message(STATUS "No CMAKE_BUILD_TYPE given: the library will be slow. Use -DCMAKE_BUILD_TYPE=Release.")
endif()
