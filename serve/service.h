// The interface of the page: one table of routes, used to answer requests and to generate the API document.
#pragma once

#include "serve/forms.h"
#include "serve/jobs.h"
#include "serve/live_feed.h"
#include "serve/message.h"
#include "serve/results.h"
#include "serve/workspace.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace schuler::serve {

struct ServiceSettings {
    std::filesystem::path workspace = "out";
    std::filesystem::path opened;   ///< a user data set; may be empty
    std::filesystem::path tiles;    ///< of a map, ZOOM/X/Y.png; may be empty
    std::filesystem::path program;  ///< executable used for runs
    std::string version;
    LiveAddress live;                                        ///< of a running `schuler live`; may be empty
    std::uintmax_t max_upload = std::uintmax_t{2048} << 20;  ///< bytes of one file; eight times this in total
    std::size_t runs_at_once = 0;                            ///< 0: the number of cores, at most four
};

struct Parameter {
    std::string name, type, what;
};

struct Route {
    std::string method, path, summary;
    std::vector<Parameter> query;
    std::string body;  ///< content of the JSON body; empty: none
    std::string answer;
    std::function<Reply(const Request&)> handle;  ///< empty: the upload route, whose body is streamed
};

class Service {
public:
    /// @throws Error(Input) if the workspace cannot be used
    explicit Service(ServiceSettings settings);
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    /// Never throws: refusals and errors are returned as replies.
    [[nodiscard]] Reply answer(Request request) noexcept;

    /// The server ends: what is being computed for an answer is not waited for.
    void hurry() { jobs_.cancel_asides(); }

    /// The file created by an upload to this path; `length`: as announced, 0 if unknown. @throws Refusal
    [[nodiscard]] std::unique_ptr<Upload> upload(const std::string& path, std::uintmax_t length);
    /// True if a request is an upload, whose body is not JSON.
    [[nodiscard]] static bool is_upload(const std::string& method, const std::string& path);

    [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }
    /// The OpenAPI 3.1 document of the routes.
    [[nodiscard]] Json openapi() const;

    static constexpr std::size_t largest_body = 4u << 20;

private:
    void add_settings_routes();
    void add_dataset_routes();
    void add_run_routes();
    void add_study_routes();
    void add_result_routes();
    void add_noise_routes();
    void add_kept_routes();
    void add_batch_routes();
    void add_live_routes();
    void add_tile_routes();
    [[nodiscard]] Json tile_zooms() const;
    [[nodiscard]] Reply dispatch(Request& request);
    [[nodiscard]] Reply start_run(const Json& order);
    [[nodiscard]] Reply start_study(const Json& order);
    /// A run of each data set with the same order. One that cannot be started is recorded as a failed run. @throws Refusal
    [[nodiscard]] Json start_batch(const Json& order);
    [[nodiscard]] Json inspected(const std::string& dataset);
    /// JSON output of the program, executed in a child that may read only `readable`. @throws Refusal 422
    [[nodiscard]] Json asked_of_program(const std::string& what, std::vector<std::string> arguments,
                                        const std::filesystem::path& readable, const std::filesystem::path& writable,
                                        double limit_s = 120.0, std::size_t limit_bytes = std::size_t{4} << 30);
    /// Effect of settings (serve/forms.h), evaluated in a child: a scenario may take unlimited time and memory. `body`: as for
    /// POST /api/settings. @throws Refusal
    [[nodiscard]] Json understood_aside(const Json& body, Form form);
    /// The folder of a run, after a child has read its run.h5: the HDF5 library does not survive every damaged file. @throws Refusal
    [[nodiscard]] std::filesystem::path readable_run(const std::string& id);
    [[nodiscard]] Json noise_of_run(const std::string& run);
    [[nodiscard]] Json run_now(const std::string& id) const;
    void check_dataset(const std::filesystem::path& folder) const;
    [[nodiscard]] Confinement confinement(const std::filesystem::path& readable, const std::filesystem::path& writable) const;
    [[nodiscard]] std::string events_after(std::uint64_t& version) const;
    void finished(const JobReport& report);

    const ServiceSettings settings_;
    Workspace workspace_;
    Results results_;
    std::mutex read_mutex_;
    std::set<std::string> read_before_;  ///< files already read by a child, with size and time
    std::vector<Route> routes_;
    Jobs jobs_;  ///< last: its thread uses the members above
};

}  // namespace schuler::serve
