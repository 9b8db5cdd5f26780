# SPDX-License-Identifier: Apache-2.0
# Writes OUTPUT from INPUT with the commit of SOURCE; does not touch OUTPUT if nothing has changed.
# cmake -DSOURCE=<folder> -DGIVEN=<commit, if it is known> -DVERSION=… -DBUILD=… -DINPUT=… -DOUTPUT=… -P commit.cmake
set(COMMIT "${GIVEN}")
find_program(GIT git)
if(NOT COMMIT AND GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --abbrev=12 --exclude=* --dirty=+changes
    OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT COMMIT)
  set(COMMIT unknown)
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
