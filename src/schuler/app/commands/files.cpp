// Commands for files.
#include "schuler/app/commands.h"
#include "schuler/app/commands/builders.h"
#include "schuler/app/formats_command.h"

namespace schuler::app {
namespace {

struct FilesRequest {
    std::filesystem::path in, out;
    std::string format, version;
    double settle = 0.0;
    bool explain = false;
};

using R = FilesRequest;

Option<R> first(const char* value_name, const char* key, const char* help) {
    return argument(value_name, path<R>(key, help, [](auto& r) -> auto& { return r.in; }));
}
Option<R> second(const char* value_name, const char* key, const char* help) {
    return argument(value_name, path<R>(key, help, [](auto& r) -> auto& { return r.out; }));
}

}  // namespace

void add_file_commands(std::vector<Command>& list) {
    OptionTable<R> evaluate, inspect, convert;
    evaluate.add(first("SOLUTION", "solution", "solution.csv, a folder with one, or any trajectory that can be read"))
        .add(second("REFERENCE", "reference", "reference.csv, a solution, or ten columns: t lat lon h vN vE vD roll pitch yaw"))
        .add(in_units("s", settings::number<R>("settle", 1.0, 0, 1e9, "seconds skipped at the start",
                                               [](auto& r) -> auto& { return r.settle; })));
    list.push_back(command<R>(
        "evaluate", "evaluate the errors of a solution against a reference",
        "  schuler evaluate out/drive/solution.csv drive/reference.csv\n  schuler evaluate out/drive truth.txt --settle 300 --json",
        std::move(evaluate), "one JSON document with the fields of summary.json", false,
        [](const R& r) { return evaluate_files(r.in, r.out, r.settle); }));
    inspect.add(first("PATH", "path", "file or folder"))
        .add(lettered(
            'o',
            written("DIR", path<R>("output",
                                   "folder for report.html: time spans of every stream, gaps, stationary periods, track, tables",
                                   [](auto& r) -> auto& { return r.out; }))))
        .add(settings::flag<R>("explain", "print the interpretation of each column", [](auto& r) -> auto& { return r.explain; }));
    list.push_back(command<R>(
        "inspect", "show the content of a file or folder, the problems found, and a draft of dataset.toml",
        "  schuler inspect drive/\n  schuler inspect flight.ulg\n  schuler inspect imu.csv --explain\n  schuler inspect drive/ -o out/found\n  schuler inspect imu.csv --json",
        std::move(inspect), one_json_document, false, [](const R& r) {
            report::Outcome found = inspect_path(r.in, r.out, r.version);
            if (r.explain) found.tables += "\n" + explained(r.in);
            return found;
        }));
    convert
        .add(first(
            "IN", "in",
            "any trajectory that can be read, a log of instruments or FILE#STREAM, or raw measurements (RINEX, UBX, RTCM 3)"))
        .add(second("OUT", "out", "file to write; a folder for every stream as a table"))
        .add(written("FORMAT", otherwise("from the extension of OUT",
                                         settings::text<R>("to", "output format (schuler help formats), rinex-obs or rinex-nav",
                                                           [](auto& r) -> auto& { return r.format; }))));
    list.push_back(command<R>(
        "convert", "convert a solution from one format to another",
        "  schuler convert receiver.ubx rover.obs               and receiver.ubx rover.nav: RINEX 3.04\n"
        "  schuler convert flight.ulg flight/                   every instrument as a table\n  schuler convert flight.ulg#imu imu.csv\n"
        "  schuler convert out/drive/run.h5 track.gpx\n  schuler convert truth.txt reference.csv\n  schuler convert out/drive/solution.csv track.kml\n"
        "  schuler convert reference.csv truth.txt --to kf-gins",
        std::move(convert), "", false, [](const R& r) { return convert_file(r.in, r.out, r.format); }));
}

}  // namespace schuler::app
