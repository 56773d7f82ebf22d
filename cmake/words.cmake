# hmesh_add_words(<target> <name>): the manual page and the completions of a command, which are what it prints, made with it where
# it runs, and installed with it.
function(hmesh_add_words target name)
    if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
        return()
    endif()
    set(words "${CMAKE_CURRENT_BINARY_DIR}/words")
    add_custom_command(TARGET ${target} POST_BUILD
        COMMAND "${CMAKE_COMMAND}" "-DHMESH_COMMAND=${CMAKE_CROSSCOMPILING_EMULATOR};$<TARGET_FILE:${target}>"
                "-DHMESH_NAME=${name}" "-DHMESH_WORDS=${words}" -P "${PROJECT_SOURCE_DIR}/cmake/command_words.cmake"
        VERBATIM)
    if(HMESH_INSTALL)
        install(FILES "${words}/${name}.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
        install(FILES "${words}/${name}.bash" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME ${name})
        install(FILES "${words}/_${name}" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions")
        install(FILES "${words}/${name}.fish" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d")
    endif()
endfunction()
