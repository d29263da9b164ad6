// docs/files.md is what the registry and the dictionary of columns say. SCHULER_UPDATE=1 writes it.
#include "schuler/io/formats.h"

#include "io/io_fixture.h"

#include <cstdlib>

namespace schuler::io {
namespace {

TEST(FormatsDocument, IsInStepWithTheProgram) {
    const std::filesystem::path file = std::filesystem::path(SCHULER_SOURCE_DIR) / "docs/files.md";
    const std::string now = formats_document();
    if (std::getenv("SCHULER_UPDATE") != nullptr) std::ofstream(file, std::ios::binary) << now;
    EXPECT_EQ(schuler::test::content_of(file), now) << "renew it: SCHULER_UPDATE=1";
    for (const Format* f : formats()) {
        EXPECT_NE(now.find("| `" + std::string(f->name) + "` |"), std::string::npos) << f->name;
        EXPECT_NE(formats_text().find("  " + std::string(f->name) + " "), std::string::npos) << f->name;
    }
    for (const char* column :
         {"gyro_x_rad_s", "height_m", "std_vel_m_s", "pressure_pa", "mag_z_ut", "heading_deg", "pseudorange_m"})
        EXPECT_NE(now.find("| `" + std::string(column)), std::string::npos) << column;
}

}  // namespace
}  // namespace schuler::io
