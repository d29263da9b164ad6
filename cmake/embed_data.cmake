# Writes SOURCE, which defines NAMESPACE::embedded_file(), declared in HEADER, with the FILES in it: the assembler puts their bytes into the
# program as they are. NAME makes the symbols unique.
set(data "")
set(table "")
set(number 0)
foreach(file ${FILES})
    get_filename_component(name "${file}" NAME)
    file(SHA256 "${file}" digest)   # makes the compiler see a change of the file
    set(symbol "schuler_${NAME}_${number}")
    string(APPEND data "// ${digest}\nasm(\".section .rodata\\n.balign 16\\n${symbol}:\\n.incbin \\\"${file}\\\"\\n${symbol}_end:\\n.previous\\n\");\n"
           "extern \"C\" const char ${symbol}[], ${symbol}_end[];\n")
    string(APPEND table "    if (name == \"${name}\") return {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})};\n")
    math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${SOURCE}" "// Made by cmake/embed_data.cmake.\n#include \"${HEADER}\"\n\n#include \"schuler/core/error.h\"\n\n#include <cstddef>\n\n${data}\n"
     "namespace ${NAMESPACE} {\n\nstd::string_view embedded_file(std::string_view name) {\n${table}"
     "    throw input_error(\"the program has no file \" + std::string(name));\n}\n\n}  // namespace ${NAMESPACE}\n")
