// KML and HDF5 output.
#include "schuler/io/container/hdf5_file.h"
#include "schuler/io/own_files.h"
#include "schuler/io/solution/kml.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_events.h"

#include "io/io_fixture.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

namespace schuler::io {
namespace {

class Kml : public test::IoTest {};
class Hdf5 : public test::IoTest {};

TEST_F(Kml, TrackIsThinnedAndKeepsItsEnds) {
    std::vector<SolutionRow> rows(1001);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].time.ns = static_cast<std::int64_t>(i) * 1'000'000'000;
        rows[i].position = {0.5 * std::numbers::pi / 180.0, static_cast<double>(i) * 0.001 * std::numbers::pi / 180.0, 12.345};
    }
    const std::string text = track_kml(rows, "a<b&c", 100);
    test::expect_parts(text, {"<name>a&lt;b&amp;c</name>", "<name>start</name>", "1000.000 s", "0.00000000,0.50000000,12.3",
                              "1.00000000,0.50000000,12.3"});
    const std::size_t line = text.find("<LineString>");
    const auto points = std::count(text.begin() + static_cast<std::ptrdiff_t>(line), text.end(), '\n');
    EXPECT_LE(points, 105);
    EXPECT_GE(points, 80);
    EXPECT_NE(text.find("1.00000000,0.50000000", line), std::string::npos);
    EXPECT_NE(track_kml({}, "empty").find("</kml>"), std::string::npos);
    write_track_kml(folder() / "track.kml", rows, "x");
    EXPECT_EQ(content_of(folder() / "track.kml"), track_kml(rows, "x"));
}

class Events : public test::IoTest {};

TEST_F(Events, KeepTheirOrderNamesAndLines) {
    std::ofstream(folder() / "shots.csv") << "# exposures\nname,time_s\nB,12.5\n\"a, \"\"b\"\"\",3.25\n,7\n";
    const std::vector<NamedInstant> events = read_events_csv(TextInput(folder() / "shots.csv"));
    ASSERT_EQ(events.size(), 3u);
    EXPECT_EQ(events[0].name, "B");
    EXPECT_EQ(events[1].time.ns, 3'250'000'000);
    EXPECT_EQ(events[1].name, "a, \"b\"");
    EXPECT_EQ(events[2].name, "");
    EXPECT_EQ(events[2].line, 5);
    std::vector<SolutionRow> rows(3);
    for (std::size_t i = 0; i < 3; ++i) rows[i].time = events[i].time;
    rows[2].position = {std::nan(""), std::nan(""), std::nan("")};
    write_events_csv(folder() / "events.csv", events, rows);
    const std::string text = content_of(folder() / "events.csv");
    test::expect_parts(text, {std::string(solution_csv_header()) + ",name\n", "\n12.500,0.0000000000,", ",B\n", "\n7.000,,,,"});

    std::ofstream(folder() / "bad.csv") << "time_s,name\n1,x\nsoon,y\n";
    test::expect_parts(test::message_of([&] { (void)read_events_csv(TextInput(folder() / "bad.csv")); }),
                       {"bad.csv:3", "time_s"});
    for (const char* time : {"nan", "abc"}) {
        std::ofstream(folder() / "bad.csv") << "time_s,name\n" << time << ",x\n100,y\n";
        test::expect_parts(test::message_of([&] { (void)read_events_csv(TextInput(folder() / "bad.csv")); }),
                           {"bad.csv:2", "time_s", time});
    }
    std::ofstream(folder() / "units.csv") << "time_s,name\ns,-\n1,x\n";
    EXPECT_EQ(read_events_csv(TextInput(folder() / "units.csv")).size(), 1u);
    std::ofstream(folder() / "bare.csv") << "t,name\n1,x\n";
    test::expect_parts(test::message_of([&] { (void)read_events_csv(TextInput(folder() / "bare.csv")); }),
                       {"bare.csv", "time_s"});
}

TEST_F(Hdf5, RoundTripAndSameBytes) {
    const auto write_one = [&](const std::string& name) {
        Hdf5Writer writer(folder() / name);
        writer.attribute("/", "name", "car");
        std::vector<double> values(3 * 5000);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.1 * static_cast<double>(i);
        writer.create_table("/solution/position", 3, {{"unit", "m"}, {"columns", "north,east,down"}});
        writer.append("/solution/position", std::span(values).first(3 * 1234));
        writer.append("/solution/position", std::span(values).subspan(3 * 1234));
        writer.table("/innovations/gnss", std::vector<double>{1.0, 2.0}, 1, {{"unit", "m"}});
        writer.integers("/solution/time_ns", std::vector<std::int64_t>{5, 6, 1'000'000'000'000});
        EXPECT_FALSE(std::filesystem::exists(folder() / name));
        writer.commit();
    };
    write_one("a.h5");
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // time stamps of HDF5 have whole seconds
    write_one("b.h5");
    EXPECT_EQ(content_of(folder() / "a.h5"), content_of(folder() / "b.h5"));
    for (const auto& entry :
         std::filesystem::directory_iterator(folder()))  // nothing is left of the writing but the list of own files
        EXPECT_TRUE(entry.path().extension() == ".h5" || entry.path().filename() == own_files_list) << entry.path();
    const Hdf5Reader reader(folder() / "a.h5");
    const Hdf5Table t = reader.table("/solution/position");
    ASSERT_EQ(t.rows, 5000U);
    ASSERT_EQ(t.columns, 3U);
    EXPECT_EQ(t(1234, 0), 0.1 * 3702.0);
    EXPECT_EQ(t(4999, 2), 0.1 * 14999.0);
    const std::vector<std::vector<double>> columns = reader.columns("/solution/position");
    ASSERT_EQ(columns.size(), 3U);
    for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(columns[c].size(), t.rows);
        for (std::size_t r = 0; r < t.rows; ++r) ASSERT_EQ(columns[c][r], t(r, c)) << r << " " << c;
    }
    EXPECT_EQ(reader.read_through("/solution/position"), 5000U);
    EXPECT_EQ(reader.columns("/solution/time_ns").at(0), (std::vector<double>{5, 6, 1e12}));
    EXPECT_EQ(reader.table("/solution/time_ns")(2, 0), 1e12);
    EXPECT_EQ(reader.attribute("/solution/position", "columns"), "north,east,down");
    EXPECT_EQ(reader.attribute("/", "name"), "car");
    EXPECT_EQ(reader.names("/"), (std::vector<std::string>{"innovations", "solution"}));
    EXPECT_EQ(reader.names("/solution"), (std::vector<std::string>{"position", "time_ns"}));
}

TEST_F(Hdf5, ErrorsAreNamed) {
    using test::expect_parts;
    using test::message_of;
    expect_parts(message_of([&] { Hdf5Writer writer(folder() / "no/f.h5"); }), {"no/f.h5", "cannot be written"});
    expect_parts(message_of([&] { Hdf5Reader reader(folder() / "none.h5"); }), {"none.h5", "no such file"});
    expect_parts(message_of([&] { Hdf5Reader reader(write("text.h5", "hello")); }), {"text.h5", "not an HDF5 file"});
    {
        Hdf5Writer writer(folder() / "left.h5");
        writer.table("/a", std::vector<double>{1.0}, 1);
        EXPECT_THROW(writer.create_table("/a", 1), Error);
        EXPECT_THROW(writer.append("/b", std::vector<double>{1.0}), Error);
    }
    EXPECT_FALSE(std::filesystem::exists(folder() / "left.h5"));
    Hdf5Writer writer(folder() / "c.h5");
    writer.table("/a", std::vector<double>{1.0}, 1);
    writer.commit();
    expect_parts(message_of([&] { (void)Hdf5Reader(folder() / "c.h5").table("/b"); }), {"c.h5", "/b", "no such object"});
}

}  // namespace
}  // namespace schuler::io
