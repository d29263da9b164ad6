// A car's navigation fed sample by sample: it stands, levels itself, finds its heading as it drives off, and says where it is now.
#include <schuler/core/units.h>
#include <schuler/earth/earth.h>
#include <schuler/filter/navigator.h>
#include <schuler/sim/simulate.h>

#include <cmath>
#include <cstdio>

int main() {
    using namespace schuler;
    sim::Scenario drive;  // in place of the drivers of real instruments
    drive.duration = 90.0;
    drive.path = sim::town_route({55.0 * units::deg, 37.0 * units::deg, 150.0}, drive.duration, 7);
    drive.imu.errors = sensor::imu_grade("mems");
    drive.gnss.rate = 5.0;
    const sim::SimulatedData data = sim::simulate(drive);

    filter::NavigatorSettings settings;
    settings.filter.vehicle = filter::VehicleKind::Car;
    settings.filter.imu.kind = data.imu_kind;
    settings.filter.imu.errors = drive.imu.errors;
    settings.imu_interval = 1.0 / drive.imu.rate;
    filter::NavigatorMade made = filter::Navigator::make(settings);
    if (!made) return std::printf("%s: %s\n", made.key.c_str(), made.reason.c_str()), 1;
    filter::Navigator& navigator = *made.navigator;

    std::size_t k = 0;
    for (const ImuSample& imu : data.recording.imu) {
        for (; k < data.recording.gnss.size() && data.recording.gnss[k].time <= imu.time; ++k)
            (void)navigator.feed(data.recording.gnss[k]);  // in any order within settings.lag; the answer says what became of it
        (void)navigator.feed(imu);
        while (const auto event = navigator.poll())
            if (event->kind == filter::NavigatorEvent::Kind::Phase)
                std::printf("%.1f s: phase %d\n", event->time.seconds(), static_cast<int>(event->phase));
    }
    const auto state = navigator.state();
    if (!state) return std::printf("no heading was found\n"), 1;
    const ReferenceSample& truth = data.recording.reference.back();
    std::printf("%.2f s: %.2f m off, by its own account %.2f m\n", state->nav.time.seconds(),
                earth::ned_difference({}, state->nav.position, truth.position).norm(),
                std::sqrt(state->covariance.topLeftCorner<3, 3>().trace()));
}
