// The registry, and round trips of every format that is written.
#include "schuler/io/formats.h"

#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_recording.h"

#include "io/io_fixture.h"

#include <cmath>
#include <set>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

class Formats : public test::IoTest {};

std::vector<SolutionRow> drive() {
    std::vector<SolutionRow> rows;
    for (int i = 0; i < 400; ++i) {
        SolutionRow r;
        r.time = Time::from_gps(2300, 138'000.0 + 0.05 * i);
        r.position = {(48.1 + 1e-5 * i) * units::deg, (-11.6 - 2e-5 * i) * units::deg, 512.3456 + 0.01 * i};
        r.v_eb_n = {1.25 + 0.001 * i, -7.5, -0.0625};  // the way that the positions go: readers of SBET look
        r.rpy = {0.01 * std::sin(0.1 * i), -0.02, 4.0 + 0.001 * i};
        r.std_position = {0.021, 0.034, 0.055};
        r.std_velocity = {0.013, 0.012, 0.011};
        r.std_rpy = {0.001, 0.002, 0.03};
        rows.push_back(r);
    }
    return rows;
}

/// What a format keeps of a row, and to what.
struct Kept {
    const char* format;
    const char* file;
    double angle_m, height_m, velocity_m_s, attitude_rad, sigma_m;  ///< NaN: not kept
    std::int64_t time_ns;
};
constexpr double no = std::numeric_limits<double>::quiet_NaN();

TEST_F(Formats, EveryFormatHasItsNameAndIsRecognisedOrWritten) {
    std::set<std::string_view> names;
    for (const Format* f : formats()) {
        EXPECT_TRUE(names.insert(f->name).second) << f->name;
        EXPECT_FALSE(f->title.empty() || f->extensions.empty() || f->holds.empty()) << f->name;
        EXPECT_TRUE(f->recognise != nullptr || f->write != nullptr) << f->name;
        EXPECT_TRUE(f->read == nullptr || f->recognise != nullptr) << f->name;
        EXPECT_EQ(format_named(f->name), f);
    }
    EXPECT_EQ(format_named("nothing"), nullptr);
    EXPECT_EQ(format_to_write("a.gpx")->name, "gpx");
    EXPECT_EQ(format_to_write("a.pos")->name, "rtklib_pos");
    EXPECT_EQ(format_to_write("a.xyz"), nullptr);
}

/// The trajectory in a file, as a user gets it.
std::vector<SolutionRow> read_back(const std::filesystem::path& file) {
    WarningLog warnings;
    const Format* format = format_of(file);
    if (format == nullptr || format->read == nullptr) return {};
    const StreamLog log = format->read(TextInput(file), warnings);
    EXPECT_TRUE(warnings.empty()) << warnings.summary().front();
    std::vector<SolutionRow> rows;
    const Stream& s = log.streams.front();
    const std::string text = table_text(s, Clock::Boot);
    const TextInput table = TextInput::memory(text, file.string());
    if (s.kind == TableKind::Gnss) {
        for (const GnssFix& f : read_gnss_csv(table, {}, warnings).fixes)
            rows.push_back({f.time, f.position, f.velocity_n, not_given3(), f.std_position, f.std_velocity, not_given3()});
    } else {
        const bool sigmas = s.find("std_roll_deg") != nullptr;
        if (sigmas) return read_solution_csv(table, warnings);
        for (const ReferenceSample& r : read_reference_csv(table, {}, warnings).samples)
            rows.push_back({r.time, r.position, r.velocity_n, r.rpy, not_given3(), not_given3(), not_given3()});
    }
    return rows;
}

TEST_F(Formats, RoundTripsAreExactToTheResolutionOfTheFormat) {
    const std::vector<SolutionRow> rows = drive();
    const std::int64_t leap = 18'000'000'000;
    const std::int64_t since_1970 = unix_time_of_gps_epoch * 1'000'000'000 - leap;
    const std::int64_t weeks = -Time::from_gps(2300, 0.0).ns;
    const Kept kept[] = {
        {"sbet", "a.sbet", 1e-8, 1e-12, 1e-12, 1e-14, no, weeks},
        {"mat", "a.mat", 1e-8, 1e-12, 1e-12, 1e-14, 1e-15, 500},  // doubles of 1.4e9 s are 0.24 us apart
        {"hdf5", "a.h5", 1e-8, 1e-12, 1e-12, 1e-14, 1e-15, 250},
        {"gpx", "a.gpx", 6e-6, 5.1e-5, no, no, no, 0},
        {"tum", "a.tum", 1.5e-6, 1.5e-6, no, 3e-9, no, since_1970},
        {"euroc", "a.euroc", 1.5e-6, 1.5e-6, no, 3e-9, no, since_1970},
        {"rtklib_pos", "a.pos", 6e-6, 5.1e-5, 5.1e-6, no, 5.1e-6, 0},
        {"nmea", "a.nmea", 1e-5, 5.1e-5, 1e-5, no, 5.1e-5, 0},
        {"mcap", "a.mcap", 1e-8, 1e-12, 1e-12, no, 1e-9, since_1970},
    };
    for (const Kept& k : kept) {
        const std::filesystem::path file = folder() / k.file;
        format_named(k.format)->write(file, rows, "drive");
        EXPECT_EQ(format_of(file), format_named(k.format)) << k.file << " is recognised as what it is";
        const std::vector<SolutionRow> back = read_back(file);
        ASSERT_EQ(back.size(), rows.size()) << k.format;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const SolutionRow &a = rows[i], &b = back[i];
            const std::int64_t shift = k.time_ns == since_1970 || k.time_ns == weeks ? k.time_ns : 0,
                               slack = shift != 0 ? 0 : k.time_ns;
            ASSERT_LE(std::abs(b.time.ns - a.time.ns - shift), slack) << k.format << " row " << i;
            ASSERT_NEAR((b.position.lat - a.position.lat) * 6.4e6, 0.0, k.angle_m) << k.format << " row " << i;
            ASSERT_NEAR((b.position.lon - a.position.lon) * 4.3e6, 0.0, k.angle_m) << k.format;
            ASSERT_NEAR(b.position.h, a.position.h, k.height_m) << k.format;
            // NMEA has the horizontal velocity alone
            const int axes = std::string_view(k.format) == "nmea" ? 2 : 3;
            for (int j = 0; j < axes && !std::isnan(k.velocity_m_s); ++j)
                ASSERT_NEAR(b.v_eb_n(j), a.v_eb_n(j), k.velocity_m_s) << k.format << " " << j;
            for (int j = 0; j < 3 && !std::isnan(k.attitude_rad); ++j)
                ASSERT_NEAR(b.rpy(j), a.rpy(j), k.attitude_rad) << k.format << " " << j;
            for (int j = 0; j < 3 && !std::isnan(k.sigma_m); ++j)
                ASSERT_NEAR(b.std_position(j), a.std_position(j), k.sigma_m) << k.format << " " << j;
        }
    }
}

TEST_F(Formats, MapsAreWrittenWhole) {
    const std::vector<SolutionRow> rows = drive();
    for (const char* name : {"geojson", "kml", "csv", "kf-gins"}) {
        const std::filesystem::path file = folder() / (std::string("out.") + name);
        format_named(name)->write(file, rows, "a \"name\" <&>");
        EXPECT_GT(std::filesystem::file_size(file), 10'000U);
    }
    const std::string json = content_of(folder() / "out.geojson");
    expect_parts(json, {"[-11.6000000000,48.1000000000,512.3456]", "2024-02-05T14:19:42Z", R"(a \"name\" <&>)"});
}

TEST_F(Formats, AStreamIsOpenedByItsName) {
    const std::filesystem::path file = folder() / "run.h5";
    format_named("hdf5")->write(file, drive(), "run");
    WarningLog warnings;
    LogFiles logs;
    const TextInput input = logs.open(file.string() + "#solution", warnings);
    EXPECT_TRUE(input.in_memory());
    EXPECT_TRUE(input.content().starts_with("time_s,lat_deg,lon_deg,height_m"));
    expect_parts(message_of([&] { (void)logs.open(file.string() + "#imu", warnings); }),
                 {"run.h5", "no stream \"imu\"", "it holds solution"});
    EXPECT_FALSE(logs.open(file, warnings).in_memory());
    format_named("gpx")->write(folder() / "track.gpx", drive(), "track");
    EXPECT_TRUE(logs.open(folder() / "track.gpx", warnings).content().starts_with("time_gps_s,lat_deg,lon_deg,height_m"));
    EXPECT_EQ(stream_path("no/such#file").stream, "");
}

TEST_F(Formats, ForeignAndCutFilesAreRefusedWithFileAndReason) {
    const std::vector<SolutionRow> rows = drive();
    for (const char* name : {"sbet", "mat", "hdf5", "mcap", "gpx", "tum", "euroc", "rtklib_pos", "nmea"}) {
        const Format& format = *format_named(name);
        const std::filesystem::path whole = folder() / (std::string("whole_") + name);
        format.write(whole, rows, "run");
        const std::string bytes = content_of(whole);
        for (const double share : {0.0, 0.01, 0.1, 0.5, 0.9}) {
            const auto file = write("cut", bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
            WarningLog warnings;
            try {
                (void)format.read(TextInput(file), warnings);
            } catch (const Error& e) {
                EXPECT_EQ(e.kind(), ErrorKind::Input) << name;
                EXPECT_NE(std::string(e.what()).find("cut"), std::string::npos) << name << ": " << e.what();
                EXPECT_FALSE(e.hint().empty()) << name << ": " << e.what();
            }
        }
        const auto foreign = write("foreign", "This is no log of any kind.\nIt has two lines.\n");
        WarningLog warnings;
        expect_parts(message_of([&] { (void)format.read(TextInput(foreign), warnings); }), {"foreign"});
    }
}

}  // namespace
}  // namespace schuler::io
