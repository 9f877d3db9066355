# Writes OUTPUT, a C++ source with the files of the built page in the folder PAGE, compressed.
set(types ".html=text/html; charset=utf-8" ".js=text/javascript" ".css=text/css")
file(GLOB files RELATIVE "${PAGE}" "${PAGE}/*")
set(arrays "")
set(entries "")
set(number 0)
foreach(file IN LISTS files)
  set(content_type "")
  foreach(type IN LISTS types)
    string(REGEX MATCH "^([^=]+)=(.+)$" matched "${type}")
    set(extension "${CMAKE_MATCH_1}")
    set(name_of_type "${CMAKE_MATCH_2}")
    get_filename_component(file_extension "${file}" LAST_EXT)
    if(file_extension STREQUAL extension)
      set(content_type "${name_of_type}")
    endif()
  endforeach()
  if(content_type STREQUAL "")
    message(FATAL_ERROR "The page has a file of unknown type: ${file}")
  endif()
  execute_process(COMMAND gzip --best --no-name --stdout "${PAGE}/${file}" OUTPUT_FILE "${OUTPUT}.gz"
    COMMAND_ERROR_IS_FATAL ANY)
  file(READ "${OUTPUT}.gz" bytes HEX)
  file(REMOVE "${OUTPUT}.gz")
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr unsigned char kFile${number}[] = {${bytes}};\n")
  string(APPEND entries "      {\"${file}\", \"${content_type}\", textOf(kFile${number})},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "#include \"view_page.hpp\"

namespace saccade::app {
namespace {

${arrays}
template <std::size_t kSize>
std::string textOf(const unsigned char (&bytes)[kSize]) {
  return {reinterpret_cast<const char*>(bytes), kSize};
}

}  // namespace

std::vector<PageFile> viewPage() {
  return {
${entries}  };
}

}  // namespace saccade::app
")
