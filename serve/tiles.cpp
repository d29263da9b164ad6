// Tiles of a map as the background of tracks: files of a folder given with --tiles, ZOOM/X/Y.png as in common map programs. No other
// server is asked.
#include "serve/names.h"
#include "serve/service.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

bool is_number(const std::string& text) {
    return !text.empty() && text.size() <= 9 &&
           std::ranges::all_of(text, [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

constexpr std::array<std::pair<const char*, const char*>, 4> tile_types{
    {{".png", "image/png"}, {".jpg", "image/jpeg"}, {".jpeg", "image/jpeg"}, {".webp", "image/webp"}}};

}  // namespace

Json Service::tile_zooms() const {
    std::vector<int> zooms;
    std::error_code ec;
    if (!settings_.tiles.empty())
        for (const auto& entry : fs::directory_iterator(settings_.tiles, ec))
            if (const std::string name = entry.path().filename().string(); entry.is_directory(ec) && is_number(name))
                zooms.push_back(std::stoi(name));
    std::ranges::sort(zooms);
    return zooms;
}

void Service::add_tile_routes() {
    routes_.push_back({"GET",
                       "/api/tiles/{zoom}/{x}/{y}",
                       "a tile of the map that --tiles names; /api/about has the zooms",
                       {},
                       "",
                       "the image, or 204 if there is none",
                       [this](const Request& r) {
                           for (const std::string& part : r.parts)
                               if (!is_number(part)) throw Refusal{400, "zoom, x and y are whole numbers"};
                           Reply reply;
                           reply.status = 204;
                           reply.type = "image/png";
                           if (settings_.tiles.empty()) return reply;
                           const fs::path folder = settings_.tiles / r.parts[0] / r.parts[1];
                           std::error_code ec;
                           for (const auto& [ending, type] : tile_types) {
                               const fs::path file = folder / (r.parts[2] + ending);
                               if (!fs::is_regular_file(file, ec)) continue;
                               reply.status = 200;
                               reply.type = type;
                               reply.file = file;
                               break;
                           }
                           return reply;
                       }});
}

}  // namespace schuler::serve
