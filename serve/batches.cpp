// Batches: several data sets processed with the same settings, each as a run of its own that bears the name of the batch.
#include "serve/replies.h"
#include "serve/service.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::serve {
namespace {

/// `title`, with a number if runs of the workspace already bear that name.
std::string unused_name(const std::string& title, const Json& runs) {
    const auto used = [&](const std::string& name) {
        return std::ranges::any_of(runs, [&](const Json& run) { return run["batch"] == name; });
    };
    std::string name = title;
    for (int number = 2; used(name); ++number) name = fmt::format("{} {}", title, number);
    return name;
}

}  // namespace

Json Service::start_batch(const Json& order) {
    constexpr std::size_t most = 1000;
    const std::string title = title_of(order, "");
    const auto datasets = order.value("datasets", std::vector<std::string>{});
    if (datasets.empty() || datasets.size() > most)
        throw Refusal{422, fmt::format("a batch has 1 to {} data sets", most), "name them in datasets", "datasets"};
    for (const std::string& dataset : datasets) (void)workspace_.dataset_folder(dataset);
    const std::string batch = unused_name(title, workspace_.runs());
    Json runs = Json::array();
    for (const std::string& dataset : datasets) {
        Json each = order;
        each.erase("datasets");
        each.update({{"kind", "dataset"}, {"dataset", dataset}, {"title", dataset}, {"batch", batch}});
        std::string failure;
        try {
            runs.push_back(Json::parse(start_run(each).body)["id"]);
        } catch (const Refusal& r) {
            failure = r.hint.empty() ? r.text : r.text + "; " + r.hint;
        } catch (const Error& e) {
            failure = e.hint().empty() ? e.reason() : e.reason() + "; " + e.hint();
        }
        if (failure.empty()) continue;
        // like `schuler batch`: one that fails does not stop the others, and has its row in the table
        runs.push_back(workspace_.new_run(
            dataset, {{"kind", "dataset"}, {"state", "failed"}, {"message", failure}, {"dataset", dataset}, {"batch", batch}}));
    }
    return {{"batch", batch}, {"runs", runs}};
}

void Service::add_batch_routes() {
    routes_.push_back({"POST",
                       "/api/batches",
                       "starts a run of each of several data sets with the same settings",
                       {},
                       "{title, datasets: [name], and command, arguments, settings or toml as POST /api/runs}",
                       "201 and {batch: its name, which the runs bear, runs: [id]}",
                       [this](const Request& r) { return json_reply(start_batch(Json::parse(r.body)), 201); }});
}

}  // namespace schuler::serve
