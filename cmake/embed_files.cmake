# Writes SOURCE, which defines schuler::serve::assets() with the files of the folder DIST and the list EXAMPLES: the assembler puts
# their bytes into the program as they are.
file(GLOB_RECURSE dist RELATIVE "${DIST}" "${DIST}/*")
set(data "")
set(table "")
set(number 0)
function(embed file path)
    # the digest makes the compiler see a change of the file
    file(SHA256 "${file}" digest)
    set(symbol "schuler_asset_${number}")
    string(APPEND data "// ${digest}\nasm(\".section .rodata\\n.balign 16\\n${symbol}:\\n.incbin \\\"${file}\\\"\\n${symbol}_end:\\n.previous\\n\");\n"
           "extern \"C\" const char ${symbol}[], ${symbol}_end[];\n")
    string(APPEND table "        {\"${path}\", {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})}},\n")
    math(EXPR number "${number} + 1")
    set(data "${data}" PARENT_SCOPE)
    set(table "${table}" PARENT_SCOPE)
    set(number "${number}" PARENT_SCOPE)
endfunction()
foreach(name ${dist})
    embed("${DIST}/${name}" "/${name}")
endforeach()
foreach(file ${EXAMPLES})
    get_filename_component(name "${file}" NAME)
    embed("${file}" "/examples/${name}")
endforeach()
file(WRITE "${SOURCE}" "// Made by cmake/embed_files.cmake.\n#include \"serve/assets.h\"\n\n#include <array>\n#include <cstddef>\n\n${data}\n"
     "namespace schuler::serve {\n\nstd::span<const Asset> assets() {\n    static const auto all = std::to_array<Asset>({\n${table}    });\n"
     "    return all;\n}\n\n}  // namespace schuler::serve\n")
