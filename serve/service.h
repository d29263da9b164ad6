// What the page can ask for: one table of routes, from which requests are answered and the API's document is made.
#pragma once

#include "serve/forms.h"
#include "serve/jobs.h"
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
    std::filesystem::path opened;   ///< a data set of the user's own; may be empty
    std::filesystem::path program;  ///< that runs are made with
    std::string version;
    std::uintmax_t max_upload = std::uintmax_t{2048} << 20;  ///< bytes of one file; all together eight times as many
    std::size_t runs_at_once = 0;                            ///< 0: as many as there are cores, four at most
};

struct Parameter {
    std::string name, type, what;
};

struct Route {
    std::string method, path, summary;
    std::vector<Parameter> query;
    std::string body;  ///< what the JSON body holds; empty: there is none
    std::string answer;
    std::function<Reply(const Request&)> handle;  ///< empty: the route of uploads, whose body is streamed
};

class Service {
public:
    /// @throws Error(Input) where the workspace cannot be used
    explicit Service(ServiceSettings settings);
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    /// Never throws: refusals and errors are replies.
    [[nodiscard]] Reply answer(Request request) noexcept;

    /// The file that an upload to this path becomes; `length`: as announced, 0 where it is not. @throws Refusal
    [[nodiscard]] std::unique_ptr<Upload> upload(const std::string& path, std::uintmax_t length);
    /// Whether a request is an upload and its body no JSON.
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
    [[nodiscard]] Reply dispatch(Request& request);
    [[nodiscard]] Reply start_run(const Json& order);
    [[nodiscard]] Reply start_study(const Json& order);
    [[nodiscard]] Json inspected(const std::string& dataset);
    /// What the program prints as JSON, asked of a child that may read only `readable`. @throws Refusal 422
    [[nodiscard]] Json asked_of_program(const std::string& what, std::vector<std::string> arguments,
                                        const std::filesystem::path& readable, const std::filesystem::path& writable,
                                        double limit_s = 120.0, std::size_t limit_bytes = std::size_t{4} << 30);
    /// What settings come to (serve/forms.h), worked out by a child: a scenario may take for ever, and all the memory there is. `body`: as for
    /// POST /api/settings. @throws Refusal
    [[nodiscard]] Json understood_aside(const Json& body, Form form);
    /// The folder of a run, once a child has read its run.h5: the library that reads it does not survive every damaged one. @throws Refusal
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
    std::set<std::string> read_before_;  ///< files that a child has read, with size and time
    std::vector<Route> routes_;
    Jobs jobs_;  ///< last: its thread uses what stands above
};

}  // namespace schuler::serve
