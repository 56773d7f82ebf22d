# WebAssembly by Emscripten, for node: each program one file that needs no other than a small worker beside it, and that sees the
# files of the machine. Threads are started before main, which runs on one of them, because a page or node starts none while a
# program waits.
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)  # Eigen is headers only
string(JOIN " " CMAKE_EXE_LINKER_FLAGS_INIT -pthread -sPROXY_TO_PTHREAD -sPTHREAD_POOL_SIZE=20 -sEXIT_RUNTIME -sSINGLE_FILE
    -sNODERAWFS -sALLOW_MEMORY_GROWTH -Wno-pthreads-mem-growth)
execute_process(COMMAND em-config EMSCRIPTEN_ROOT OUTPUT_VARIABLE root OUTPUT_STRIP_TRAILING_WHITESPACE)
include("${root}/cmake/Modules/Platform/Emscripten.cmake")
