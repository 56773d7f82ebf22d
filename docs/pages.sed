# Markdown as doxygen 1.9.4 wants it: links to headers lead to their pages, those to other files of the repository become text.
s#](\(\.\./\)*include/\(hmesh/[a-z0-9_/]*\.hpp\))#](@ref \2)#g
s#\[\([^][]*\)\](\(\.\./\)*\(cmake\|examples\|include\|packaging\|single_include\|tests\|tools\|scripts\|benchmarks\)\(/[^)]*\)*)#\1#g
