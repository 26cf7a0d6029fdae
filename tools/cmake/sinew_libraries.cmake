# What the solver links that comes without a CMake package of its own, as imported targets. Read by Sinew's build and,
# installed, by find_package(sinew): so no path of the machine that built it stands in the package.
# Sets sinew_libraries_missing to a list of what was not found.
# SPDX-License-Identifier: GPL-3.0-or-later
set(sinew_libraries_missing "")
foreach(entry "cholmod::libsuitesparse-dev" "openblas:openblas-pthread:libopenblas-pthread-dev" "gmp::libgmp-dev"
              "mpfr::libmpfr-dev")
    string(REGEX MATCH "^([^:]*):([^:]*):([^:]*)$" sinew_matched "${entry}")
    set(sinew_name ${CMAKE_MATCH_1})
    set(sinew_suffix ${CMAKE_MATCH_2})
    set(sinew_package ${CMAKE_MATCH_3})
    find_library(SINEW_${sinew_name}_LIBRARY ${sinew_name} PATH_SUFFIXES ${sinew_suffix})
    mark_as_advanced(SINEW_${sinew_name}_LIBRARY)
    if(NOT SINEW_${sinew_name}_LIBRARY)
        list(APPEND sinew_libraries_missing "${sinew_name} (Debian: ${sinew_package})")
    elseif(NOT TARGET sinew_needs::${sinew_name})
        add_library(sinew_needs::${sinew_name} UNKNOWN IMPORTED GLOBAL)
        set_target_properties(sinew_needs::${sinew_name} PROPERTIES
                              IMPORTED_LOCATION "${SINEW_${sinew_name}_LIBRARY}")
    endif()
endforeach()
