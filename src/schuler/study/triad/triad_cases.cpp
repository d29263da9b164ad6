// The cases of math.md 5.5 with their results: 48 runs of an independent simulation.
#include "schuler/study/triad/triad.h"

#include <algorithm>
#include <array>

namespace schuler::study {
namespace {

struct Arrangement {
    char key;  ///< s: those of e, the stations from 300 s on
    const char* name;
    std::size_t satellites, stations;
    double stations_on;  ///< s after the loss
};
constexpr std::array<Arrangement, 8> arrangements{{{'a', "a 4 SV", 4, 0, 0.0},
                                                   {'b', "b 3 SV", 3, 0, 0.0},
                                                   {'c', "c 2 SV", 2, 0, 0.0},
                                                   {'d', "d 4 stations", 0, 4, 0.0},
                                                   {'e', "e 2 SV+2 st.", 2, 2, 0.0},
                                                   {'s', "e stations on at 300 s", 2, 2, 300.0},
                                                   {'f', "f all in view", 99, 0, 0.0},
                                                   {'g', "f all + 4 stations", 99, 4, 0.0}}};

struct CaseRow {
    char key;
    const char* suffix;
    bool tactical, tcxo;
    double baro_sigma;                                  ///< m, 0: none
    double station_white, station_correlated, network;  ///< m
    TriadReference reference;
};
/// Results in the order of TriadReference.
constexpr auto rows = std::to_array<CaseRow>({
    {'a', " nav", false, false, 30, 10, 5, 10, {2.393, 2.614, 3.372, 3.493, 2.322, 0.984, 1.010}},
    {'a', " tac", true, false, 30, 10, 5, 10, {2.399, 2.626, 3.375, 3.5, 2.332, 0.979, 1.046}},
    {'b', " nav", false, false, 30, 10, 5, 10, {14.19, 14, 10.45, 12.26, 18.06, 0.865, 1.011}},
    {'b', " tac", true, false, 30, 10, 5, 10, {18.35, 27.4, 13.16, 16, 25.63, 0.793, 0.973}},
    {'b', " tac TCXO", true, true, 30, 10, 5, 10, {38.47, 46.78, 14.54, 16.77, 46.4, 0.839, 0.991}},
    {'b', " nav no baro", false, false, 0, 10, 5, 10, {20.51, 18.83, 19.01, 20.58, 31.5, 0.924, 1.034}},
    {'b', " nav baro 60 m", false, false, 60, 10, 5, 10, {17.39, 16.79, 14.31, 16.63, 23.71, 0.881, 1.018}},
    {'c', " nav", false, false, 30, 10, 5, 10, {32.12, 29.36, 12.65, 14.03, 48.79, 0.984, 1.095}},
    {'c', " nav TCXO", false, true, 30, 10, 5, 10, {35.39, 31.08, 12.76, 14.31, 54.53, 1.019, 1.115}},
    {'c', " tac", true, false, 30, 10, 5, 10, {165.5, 157.3, 14.77, 16.91, 253, 0.942, 1.004}},
    {'c', " tac TCXO", true, true, 30, 10, 5, 10, {441.2, 489.9, 15.31, 17.24, 729.2, 0.843, 0.985}},
    {'d', " nav", false, false, 30, 10, 5, 10, {4.882, 4.977, 12.29, 14.59, 5.737, 0.866, 0.949}},
    {'d', " tac", true, false, 30, 10, 5, 10, {5.532, 5.523, 15.26, 17.12, 6.805, 0.927, 1.015}},
    {'d', " nav no baro", false, false, 0, 10, 5, 10, {5.087, 5.119, 28.23, 31.4, 6.2, 0.881, 0.958}},
    {'e', " nav", false, false, 30, 10, 5, 10, {6.928, 7.52, 7.192, 8.397, 8.3, 0.867, 1.042}},
    {'e', " tac", true, false, 30, 10, 5, 10, {7.627, 8.401, 7.609, 9.154, 8.53, 0.836, 0.967}},
    {'e', " nav ADS-B 30/10 m", false, false, 30, 30, 10, 10, {12.28, 12.21, 8.752, 10.11, 14.97, 0.896, 1.063}},
    {'e', " nav network 30 m", false, false, 30, 10, 5, 30, {8.134, 8.938, 9.219, 10.87, 10.75, 0.853, 1.040}},
    {'s', " nav", false, false, 30, 10, 5, 10, {7.926, 8.651, 8.232, 9.315, 8.794, 0.842, 1.040}},
    {'s', " tac", true, false, 30, 10, 5, 10, {16.87, 16.92, 8.986, 11.01, 9.776, 0.773, 0.949}},
    {'f', " nav", false, false, 30, 10, 5, 10, {2.17, 2.166, 3.252, 3.171, 1.916, 0.966, 1.034}},
    {'g', " nav", false, false, 30, 10, 5, 10, {1.806, 1.937, 2.913, 3.007, 1.65, 0.872, 0.996}},
});

TriadCase arranged(const Arrangement& a) {
    TriadCase c;
    c.name = a.name;
    c.key = a.key;
    c.satellites = a.satellites;
    c.stations = a.stations;
    c.stations_on = a.stations_on;
    return c;
}

}  // namespace

std::vector<TriadCase> triad_cases() {
    std::vector<TriadCase> out;
    for (const CaseRow& r : rows) {
        TriadCase c = arranged(*std::ranges::find(arrangements, r.key, &Arrangement::key));
        c.name += r.suffix;
        c.tactical = r.tactical;
        c.tcxo = r.tcxo;
        c.baro = r.baro_sigma > 0.0;
        if (c.baro) c.baro_sigma = r.baro_sigma;
        c.station_white = r.station_white;
        c.station_correlated = r.station_correlated;
        c.network = r.network;
        c.reference = r.reference;
        out.push_back(std::move(c));
    }
    return out;
}

std::vector<TriadCase> triad_cases_with(bool tactical, bool tcxo, double baro_sigma) {
    const std::vector<TriadCase> known = triad_cases();
    std::vector<TriadCase> out;
    for (const Arrangement& a : arrangements) {
        TriadCase c = arranged(a);
        c.tactical = tactical;
        c.tcxo = tcxo;
        c.baro = baro_sigma > 0.0;
        if (c.baro) c.baro_sigma = baro_sigma;
        const auto same = std::ranges::find_if(known, [&](const TriadCase& k) {
            return k.key == c.key && k.tactical == tactical && k.tcxo == tcxo && k.baro == c.baro &&
                   k.baro_sigma == c.baro_sigma && k.station_white == c.station_white && k.network == c.network;
        });
        if (same != known.end()) c.reference = same->reference;
        out.push_back(std::move(c));
    }
    return out;
}

}  // namespace schuler::study
