# hmesh_add_meshes(): images become meshes when a project is built, and again when an image, an option or hmesh changes.
#
#   hmesh_add_meshes(<target>
#       SOURCES <image>...                           seen from the current source directory
#       [RATE <percent> | VERTICES <n> | PSNR <dB>]  how many vertices each mesh has; default RATE 1
#       [MAX_VERTICES <n>]                           at most these, fewer where they are good enough; with PSNR, the build fails
#                                                    where they do not reach it
#       [SPRITE | OUTLINE]                           meshes without the faces that show nothing, or in place of meshes outlines
#                                                    of few vertices, to draw the images on: ply, obj (with a .mtl) or glb
#       [FORMAT <ending>...]                         ply (default), obj, glb, pdf, eps, svg, html, hmc; several at once
#       [EFFORT <name>]                              draft, fast, normal (default), fine or best
#       [LODS <n>]                                   levels of detail: .glb holds all, of others <name>_lod1.<ending> is the second
#       [PERIODIC x|y|xy]                            meshes of textures that tile, whose copies join; not with SPRITE or OUTLINE
#       [OUTPUT_DIRECTORY <directory>]               default: <target> in the current binary directory
#       [OPTIONS <option>...])                       more of `hmesh --help`; names of files should be absolute
#
# adds the target <target>, built by default, which makes <directory>/<name of the image>.<ending> of each image. Its property
# HMESH_FILES lists the files. add_dependencies(app <target>) makes them before app. Where images are made by commands of the
# same directory, these run first. OPTIONS may hold generator expressions; where one becomes nothing it is no option.
#
# One image has options of its own by its property HMESH_OPTIONS, in all targets of the directory and set before them:
#
#   set_source_files_properties(icon.png PROPERTIES HMESH_OPTIONS "--sprite;--vertices;500")
#
# They come behind those of the target. Its number of vertices, its EFFORT and its PERIODIC make way where the image has its own:
# --rate, --vertices, --psnr, --bytes, --max-vertices, --effort and --periodic. Which files there are is said by FORMAT, LODS and
# OUTLINE alone.
#
# What OPTIONS names, such as --weights "${CMAKE_CURRENT_SOURCE_DIR}/mask.png", is watched too: the command writes depfiles,
# which the generators of Ninja and of makefiles read. Each image is meshed on one thread, so that the build may run many at
# once; the bytes are the same for any number of threads. CMake does not quote all names for depfiles: those with a colon are
# refused, and under Ninja, which would mesh at each build, those with a dollar.
#
# The command is the variable HMESH_COMMAND, or the one that hmesh's own build makes (HMESH_BUILD_COMMAND), or the program
# `hmesh` that was installed with the package or is on the path. When cross-compiling it is one of the host: HMESH_COMMAND,
# the one on the path, or that of hmesh's own build where CMAKE_CROSSCOMPILING_EMULATOR runs it.

# The function's, whatever the project has: before 3.20 Ninja was given depfiles with names that it does not know.
cmake_policy(PUSH)
cmake_policy(VERSION 3.21...3.31)

# With a type, which makes a relative path of the command line absolute. A variable that is none of the cache stays as it is.
if(NOT DEFINED HMESH_COMMAND OR DEFINED CACHE{HMESH_COMMAND})
    set(HMESH_COMMAND "" CACHE FILEPATH "The command hmesh; where empty, the one that is built, installed or on the path")
endif()

function(hmesh_add_meshes target)
    cmake_parse_arguments(PARSE_ARGV 1 arg "SPRITE;OUTLINE"
                          "RATE;VERTICES;PSNR;MAX_VERTICES;EFFORT;LODS;PERIODIC;OUTPUT_DIRECTORY" "SOURCES;FORMAT;OPTIONS")
    if(NOT arg_SOURCES)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): SOURCES names no image")
    elseif(DEFINED arg_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
    elseif(DEFINED arg_KEYWORDS_MISSING_VALUES)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): a value is missing after ${arg_KEYWORDS_MISSING_VALUES}")
    endif()

    set(goals RATE VERTICES PSNR MAX_VERTICES)
    set(given "")
    foreach(goal IN LISTS goals)
        if(DEFINED arg_${goal})
            list(APPEND given ${goal})
        endif()
    endforeach()
    list(LENGTH given count)
    if(count GREATER 1 AND NOT "${given}" STREQUAL "PSNR;MAX_VERTICES")
        list(JOIN given " and " given)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): ${given} cannot both be given")
    endif()
    if(arg_OUTLINE)
        foreach(keyword IN ITEMS RATE VERTICES PSNR EFFORT LODS PERIODIC)
            if(DEFINED arg_${keyword})
                message(FATAL_ERROR "hmesh_add_meshes(${target}): ${keyword} means nothing to OUTLINE, which makes no mesh "
                                    "of colours")
            endif()
        endforeach()
        if(arg_SPRITE)
            message(FATAL_ERROR "hmesh_add_meshes(${target}): SPRITE and OUTLINE cannot both be given")
        endif()
    elseif(arg_SPRITE AND DEFINED arg_PERIODIC)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): SPRITE and PERIODIC cannot both be given")
    endif()
    hmesh_check_options("hmesh_add_meshes(${target}): OPTIONS" ${arg_OPTIONS})
    if(NOT arg_FORMAT)
        set(arg_FORMAT ply)
    endif()
    list(REMOVE_DUPLICATES arg_FORMAT)

    # What the command would refuse is refused now; what generator expressions become is left to it.
    set(expression "\\$<")
    set(formats ply obj glb)
    set(of_outlines " of an outline")
    if(NOT arg_OUTLINE)
        list(APPEND formats pdf eps svg html hmc)
        set(of_outlines "")
    endif()
    foreach(format IN LISTS arg_FORMAT)
        string(TOLOWER "${format}" ending)
        if(NOT ending IN_LIST formats AND NOT format MATCHES "${expression}")
            list(JOIN formats ", " formats)
            message(FATAL_ERROR "hmesh_add_meshes(${target}): FORMAT '${format}'${of_outlines} is not one of: ${formats}")
        endif()
    endforeach()
    set(efforts draft fast normal fine best)
    if(DEFINED arg_EFFORT AND NOT arg_EFFORT IN_LIST efforts AND NOT arg_EFFORT MATCHES "${expression}")
        list(JOIN efforts ", " efforts)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): EFFORT '${arg_EFFORT}' is not one of: ${efforts}")
    endif()
    set(axes none x y xy)
    if(DEFINED arg_PERIODIC AND NOT arg_PERIODIC IN_LIST axes AND NOT arg_PERIODIC MATCHES "${expression}")
        list(JOIN axes ", " axes)
        message(FATAL_ERROR "hmesh_add_meshes(${target}): PERIODIC '${arg_PERIODIC}' is not one of: ${axes}")
    endif()
    foreach(goal IN ITEMS VERTICES MAX_VERTICES)
        set(value "${arg_${goal}}")
        if(DEFINED arg_${goal} AND NOT value MATCHES "${expression}" AND
           NOT (value MATCHES "^[0-9]+$" AND value GREATER_EQUAL 4))
            message(FATAL_ERROR "hmesh_add_meshes(${target}): ${goal} '${value}' must be a whole number of at least 4")
        endif()
    endforeach()
    set(coarser "")  # numbers of the levels that have files of their own
    if(DEFINED arg_LODS)
        if(NOT (arg_LODS MATCHES "^[0-9]+$" AND arg_LODS GREATER_EQUAL 1 AND arg_LODS LESS_EQUAL 32))
            message(FATAL_ERROR "hmesh_add_meshes(${target}): LODS '${arg_LODS}' must be a whole number of 1 to 32")
        endif()
        if(arg_LODS GREATER 1)
            math(EXPR last "${arg_LODS} - 1")
            foreach(level RANGE 1 ${last})
                list(APPEND coarser ${level})
            endforeach()
        endif()
    endif()
    set(number "^[+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][+-]?[0-9]+)?$")
    set(most_RATE 100)
    set(most_PSNR 1000)
    foreach(goal IN ITEMS RATE PSNR)
        set(most ${most_${goal}})
        set(value "${arg_${goal}}")
        if(DEFINED arg_${goal} AND NOT value MATCHES "${expression}" AND
           NOT (value MATCHES "${number}" AND value GREATER 0 AND value LESS_EQUAL most))
            message(FATAL_ERROR "hmesh_add_meshes(${target}): ${goal} '${value}' must be a number above 0 and at most ${most}")
        endif()
    endforeach()

    set(directory "${CMAKE_CURRENT_BINARY_DIR}/${target}")
    if(arg_OUTPUT_DIRECTORY)
        get_filename_component(directory "${arg_OUTPUT_DIRECTORY}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
    endif()
    # Apart from the meshes, because other targets may put theirs into the same directory.
    set(depfiles "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir")
    hmesh_find_command(command)

    set(foreign "[:]")
    if(CMAKE_GENERATOR MATCHES "Ninja")
        set(foreign "[:$]")
    endif()

    set(files "")
    foreach(source IN LISTS arg_SOURCES)
        get_filename_component(image "${source}" ABSOLUTE)
        get_filename_component(name "${image}" NAME_WLE)
        string(GENEX_STRIP "${image};${arg_OUTPUT_DIRECTORY}" places)
        string(REGEX REPLACE "(^|;)[A-Za-z]:/" "\\1/" places "${places}")  # drives
        if(places MATCHES "${foreign}")
            message(FATAL_ERROR "hmesh_add_meshes(${target}): ${image} or its OUTPUT_DIRECTORY has a '${CMAKE_MATCH_0}', which "
                                "CMake does not quote for ${CMAKE_GENERATOR}")
        endif()
        set(outputs "")
        set(others "")
        foreach(format IN LISTS arg_FORMAT)
            list(APPEND outputs "${directory}/${name}.${format}")
            string(TOLOWER "${format}" ending)
            foreach(level IN LISTS coarser)
                if(NOT ending STREQUAL glb)
                    list(APPEND others "${directory}/${name}_lod${level}.${format}")
                endif()
            endforeach()
            if(arg_OUTLINE AND ending STREQUAL obj)
                list(APPEND others "${directory}/${name}.mtl")
            endif()
        endforeach()
        list(GET outputs 0 first)
        if(first IN_LIST files)
            message(FATAL_ERROR "hmesh_add_meshes(${target}): two images are named ${name}, and both would become ${first}")
        endif()
        # Another one where other files are made: Ninja refuses a depfile of before that names one which is made no more.
        string(MD5 depfile "${outputs};${others}")
        string(SUBSTRING ${depfile} 0 8 depfile)
        set(depfile "${depfiles}/${name}.${depfile}.d")
        list(TRANSFORM outputs PREPEND "--output;" OUTPUT_VARIABLE outputs_options)

        get_source_file_property(own "${source}" HMESH_OPTIONS)
        if(own STREQUAL "NOTFOUND")
            set(own "")
        endif()
        hmesh_check_options("hmesh_add_meshes(${target}): HMESH_OPTIONS of ${source}" ${own})
        # What of the target stands beside the image's own.
        set(keywords ${goals} EFFORT LODS PERIODIC)
        if(own MATCHES "(^|;)--(rate|vertices|psnr|bytes)(;|=|$)")
            list(REMOVE_ITEM keywords ${goals})
        elseif(own MATCHES "(^|;)--max-vertices(;|=|$)")
            list(REMOVE_ITEM keywords RATE VERTICES MAX_VERTICES)
        endif()
        if(own MATCHES "(^|;)--effort(;|=|$)")
            list(REMOVE_ITEM keywords EFFORT)
        endif()
        if(own MATCHES "(^|;)--periodic(;|=|$)")
            list(REMOVE_ITEM keywords PERIODIC)
        endif()
        set(options --quiet)
        foreach(keyword IN LISTS keywords)
            if(DEFINED arg_${keyword})
                string(TOLOWER ${keyword} option)
                string(REPLACE _ - option ${option})
                list(APPEND options --${option} "${arg_${keyword}}")
            endif()
        endforeach()
        if(arg_OUTLINE)
            list(APPEND options --outline)
        elseif(arg_SPRITE AND NOT own MATCHES "(^|;)--sprite(;|$)")
            list(APPEND options --sprite)
        endif()
        if(NOT "${arg_OPTIONS};${own}" MATCHES "(^|;)--threads(;|=|$)")
            list(APPEND options --threads 1)
        endif()

        add_custom_command(
            OUTPUT ${outputs} ${others}
            COMMAND "${CMAKE_COMMAND}" -E make_directory "${directory}" "${depfiles}"
            COMMAND ${command} "${image}" ${outputs_options} ${options} ${arg_OPTIONS} ${own} --depfile "${depfile}"
            DEPENDS "${image}" ${command}
            DEPFILE "${depfile}"
            COMMENT "Meshing ${name}"
            COMMAND_EXPAND_LISTS VERBATIM)
        list(APPEND files ${outputs} ${others})
    endforeach()
    add_custom_target(${target} ALL DEPENDS ${files})
    set_target_properties(${target} PROPERTIES HMESH_FILES "${files}")
endfunction()

# Refuses options that make files of which the build would not know, those of meshes for OUTLINE (the caller's arg_OUTLINE), and
# several options in one word.
function(hmesh_check_options whose)
    set(keyword_--format FORMAT)
    set(keyword_--lods LODS)
    set(keyword_--outline OUTLINE)
    foreach(option IN LISTS ARGN)
        if(option MATCHES "^(--format|--lods|--outline)(=|$)")
            message(FATAL_ERROR "${whose}: ${CMAKE_MATCH_1} says which files are made: it is ${keyword_${CMAKE_MATCH_1}} of "
                                "hmesh_add_meshes()")
        elseif(option MATCHES "^(-o|--output|--depfile)")  # -oFILE is one word
            message(FATAL_ERROR "${whose}: ${CMAKE_MATCH_1} is given by hmesh_add_meshes()")
        elseif(arg_OUTLINE AND option MATCHES "^(--rate|--vertices|--psnr|--bytes|--effort|--periodic|--sprite)(=|$)")
            message(FATAL_ERROR "${whose}: ${CMAKE_MATCH_1} means nothing to OUTLINE, which makes no mesh of colours")
        elseif(option MATCHES "^--[a-z-]+ ")
            message(FATAL_ERROR "${whose}: '${option}' is one word to CMake: options and values are apart, as in --rate;2")
        endif()
    endforeach()
endfunction()

# The command, as COMMAND and DEPENDS of add_custom_command want it, in the variable <result>. What is found is not kept in the
# cache: the next time the package may be another one.
function(hmesh_find_command result)
    if(HMESH_COMMAND)
        set(${result} "${HMESH_COMMAND}" PARENT_SCOPE)
        return()
    elseif(TARGET hmesh_command AND (NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR))
        set(${result} hmesh_command PARENT_SCOPE)
        return()
    endif()
    unset(hmesh_program)
    if(CMAKE_CROSSCOMPILING)  # the prefixes that CMake knows hold programs of the target
        find_program(hmesh_program hmesh NO_CACHE NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH PATHS ${CMAKE_PROGRAM_PATH} ENV PATH)
        set(advice "put one of this machine on the path")
    else()
        get_property(hints GLOBAL PROPERTY HMESH_COMMAND_HINTS)  # of the package
        find_program(hmesh_program hmesh NO_CACHE NO_DEFAULT_PATH HINTS ${hints})
        find_program(hmesh_program hmesh NO_CACHE)
        set(advice "set HMESH_BUILD_COMMAND to ON where hmesh is a subdirectory, or install hmesh with it")
    endif()
    if(NOT hmesh_program)
        message(FATAL_ERROR "hmesh_add_meshes() needs the command hmesh: ${advice}, or set HMESH_COMMAND to its path")
    endif()
    set(${result} "${hmesh_program}" PARENT_SCOPE)
endfunction()

cmake_policy(POP)
