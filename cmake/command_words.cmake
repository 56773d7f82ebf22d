# Writes what a command says of itself: its manual page and the completions of the shells. To be run as a script:
#   cmake "-DHMESH_COMMAND=hmesh" "-DHMESH_NAME=hmesh" "-DHMESH_WORDS=folder" -P command_words.cmake
file(MAKE_DIRECTORY "${HMESH_WORDS}")
function(hmesh_write file)
    execute_process(COMMAND ${HMESH_COMMAND} ${ARGN} OUTPUT_FILE "${HMESH_WORDS}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
hmesh_write("${HMESH_NAME}.1" --man)
hmesh_write("${HMESH_NAME}.bash" --completion bash)
hmesh_write("_${HMESH_NAME}" --completion zsh)
hmesh_write("${HMESH_NAME}.fish" --completion fish)
