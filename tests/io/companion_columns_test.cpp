// Columns that complete another: hemispheres beside coordinates, fractions beside whole seconds.
#include "schuler/io/text/csv/csv_recording.h"

#include "schuler/core/units.h"

#include "io/io_fixture.h"

#include <fmt/format.h>

namespace schuler::io {
namespace {

class Companions : public test::IoTest {
protected:
    GnssTable gnss(const std::string& text) { return read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log); }
    ImuTable imu(const std::string& text, const std::map<std::string, std::string>& columns = {}) {
        CsvOptions options;
        options.columns = columns;
        return read_imu_csv(TextInput::memory(text, "imu.csv"), options, log);
    }
    void expect_at(const std::string& text, double lat, double lon) {
        const GnssTable table = gnss(text);
        ASSERT_FALSE(table.fixes.empty()) << text;
        EXPECT_DOUBLE_EQ(table.fixes.back().position.lat / units::deg, lat) << text;
        EXPECT_DOUBLE_EQ(table.fixes.back().position.lon / units::deg, lon) << text;
        EXPECT_EQ(table.rows.bad, 0U) << text;
    }
    WarningLog log;
};

TEST_F(Companions, HemispheresGiveTheSign) {
    for (const std::string names : {"N/S,lon,E/W", "lat_dir,lon,lon_dir", "ns,lon,ew", "hemisphere,lon,hemisphere.1",
                                    "latHemi,lon,lonHemi", "NS indicator,lon,EW indicator"})
        expect_at("time,lat," + names + ",alt\n1,40.5,S,105.25,W,1580\n2,40.5,S,105.25,W,1580\n", -40.5, -105.25);
    expect_at("time,lat,N/S,lon,E/W,alt\n1,40.5,N,105.25,E,1\n2,-40.5,S,-105.25,W,1\n", -40.5, -105.25);
    expect_at("time,lat,lon,alt,lat_dir,lon_dir\n1,40.5,105.25,1,N,E\n2,40.5,105.25,1,north,West\n", 40.5, -105.25);
    expect_at("time,lat,lat_dir,lon,lon_dir,alt\n1,,,,,\n2,40.5,N,105.25,W,1\n", 40.5, -105.25);
}

TEST_F(Companions, HemispheresMayStandInTheCells) {
    expect_at("time,lat,lon,alt\n1,40.5N,105.25W,1580\n2,40.5 S,105.25 W,1580\n", -40.5, -105.25);
    expect_at("time,lat,lon,alt\n1,N40.5,W105.25,1580\n2,S40.5,\"W 105.25\",1580\n", -40.5, -105.25);
    expect_at("time,lat,lon,alt\n1,40.5\xc2\xb0,105.25\xc2\xb0W,1\n2,40.5\xc2\xb0,105.25\xc2\xb0W,1\n", 40.5, -105.25);
}

TEST_F(Companions, OtherTextIsRefused) {
    test::expect_parts(test::message_of([&] { (void)gnss("time,lat,lat_dir,lon,lon_dir,alt\n1,40.5,up,105.25,W,1\n"); }),
                       {"gnss.csv", "lat_dir", "'up' is no hemisphere of the latitude", "write N or S"});
    // A number of satellites of the same name remains one; letters of a mode are no hemispheres.
    const GnssTable table = gnss("time,lat,lon,alt,ns\n1,40.5,105.25,1,12\n2,40.5,105.25,2,11\n");
    EXPECT_EQ(table.fixes.back().satellites, 11);
    expect_at("time,lat,lon,alt,mode2\n1,40.5,105.25,1,S\n2,40.5,105.25,2,S\n", 40.5, 105.25);
}

TEST_F(Companions, FractionsAreAddedToWholeSeconds) {
    const std::string rest = ",0,0,0,0,0,-9.8\n", names = ",gx,gy,gz,ax,ay,az\n";
    for (const std::string time :
         {"secs,nsecs", "header.stamp.secs,header.stamp.nsecs", "sec,nanosec", "stamp_sec,stamp_nanosec"}) {
        const ImuTable t = imu(time + names + "1751760000,990000000" + rest + "1751760001,5" + rest);
        ASSERT_EQ(t.samples.size(), 2U) << time;
        EXPECT_EQ(t.samples[0].time.ns, 1751760000990000000) << time;
        EXPECT_EQ(t.samples[1].time.ns, 1751760001000000005) << time;
    }
    const ImuTable before = imu("nsecs,secs" + names + "990000000,1751760000" + rest + "5,1751760001" + rest);
    EXPECT_EQ(before.samples[1].time.ns, 1751760001000000005);
    EXPECT_EQ(imu("tv_usec,tv_sec" + names + "500000,7" + rest + "1,8" + rest, {{"time_s", "tv_sec"}}).samples[0].time.ns,
              7500000000);
    // A whole time in nanoseconds is no fraction.
    EXPECT_EQ(imu("time_s,time_ns" + names + "7,7500000000" + rest + "8,8000000000" + rest).samples[0].time.ns, 7000000000);
}

TEST_F(Companions, SamplesTakeTheTimeThatDoesNotRepeat) {
    std::string text = "gps_time_s,t,gx,gy,gz,ax,ay,az\n";
    for (int i = 0; i < 60; ++i) text += fmt::format("{},{:.2f},0,0,{},0,0,-9.8\n", 100 + i / 50, 7.0 + 0.02 * i, i);
    EXPECT_EQ(imu(text).samples.at(1).time.ns, 7020000000);
}

}  // namespace
}  // namespace schuler::io
