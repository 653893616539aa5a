# SPDX-License-Identifier: MIT
# Fails where the file PROGRAM has more than MOST bytes.
file(SIZE ${PROGRAM} bytes)
if(bytes GREATER MOST)
    message(FATAL_ERROR "${PROGRAM} has ${bytes} bytes, more than ${MOST}")
endif()
