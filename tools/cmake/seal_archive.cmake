# SPDX-License-Identifier: Apache-2.0
# Makes every weak symbol that an archive defines local. It first merges the archive's objects into one, in which they still
# share these symbols.
# cmake -DARCHIVE=<lib.a> -DCXX=<compiler> -DFLAGS=<flags> -DNM=… -DOBJCOPY=… -DAR=… -P seal_archive.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output)
  if(NOT result EQUAL 0)
    file(REMOVE ${ARCHIVE})  # so that an incomplete archive is not used
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

separate_arguments(flags UNIX_COMMAND "${FLAGS}")
set(object ${ARCHIVE}.o)
run(${CXX} ${flags} -r -nostdlib -o ${object} -Wl,--force-group-allocation -Wl,--whole-archive ${ARCHIVE}
  -Wl,--no-whole-archive)
run(${NM} --defined-only --format=posix ${object})
string(REGEX MATCHALL "[^\n]+ [VW] [^\n]*" lines "${output}")
list(TRANSFORM lines REPLACE " .*" "")
list(JOIN lines "\n" names)
file(WRITE ${object}.weak "${names}\n")
run(${OBJCOPY} --localize-symbols=${object}.weak ${object})
file(REMOVE ${ARCHIVE})
run(${AR} rcs ${ARCHIVE} ${object})
file(REMOVE ${object} ${object}.weak)
