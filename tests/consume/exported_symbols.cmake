#Compares what the shared library exports with the list that is checked in : LIBRARY, LIST.
#The C API symbol by symbol; of C++, that every name belongs to namespace crofton.
execute_process(COMMAND nm - D-- defined - only-- format = posix ${LIBRARY} OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL
                    ANY) string(REGEX MATCHALL "[^\n]+" lines "${lines}") set(found "") set(strangers "")
    foreach (line IN LISTS lines) string(REGEX MATCH "^[^ ]+" symbol "${line}") if (symbol MATCHES "^crofton_") string(
        APPEND found
        "${symbol}\n") elseif(NOT symbol MATCHES "^_ZT?[VISh]?[0-9a-zA-Z_]*7crofton") list(APPEND strangers ${
        symbol}) endif() endforeach() if (strangers) message(FATAL_ERROR "exported, but not ours: ${strangers}") endif()
        file(READ ${LIST} expected) if (NOT found STREQUAL expected) file(WRITE ${LIBRARY}.symbols.txt "${found}")
            message(FATAL_ERROR
                    "the C API's symbols are not those of ${LIST}.\nIf the change is meant, copy "
                    "${LIBRARY}.symbols.txt there; a symbol removed or changed also needs a new CROFTON_API_VERSION.")
                endif()
