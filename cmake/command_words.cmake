# Writes what the command says of itself: its manual page and the completions of the shells. To be run as a script:
#   cmake "-DHMESH_COMMAND=hmesh" "-DHMESH_WORDS=folder" -P command_words.cmake
file(MAKE_DIRECTORY "${HMESH_WORDS}")
function(hmesh_write file)
    execute_process(COMMAND ${HMESH_COMMAND} ${ARGN} OUTPUT_FILE "${HMESH_WORDS}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
hmesh_write(hmesh.1 --man)
hmesh_write(hmesh.bash --completion bash)
hmesh_write(_hmesh --completion zsh)
hmesh_write(hmesh.fish --completion fish)
