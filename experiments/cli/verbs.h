// What each verb of `misbench` is told and does. The files arguments*.cpp know the command line's
// syntax; a verb returns its exit code or throws Error.
//
// Exit codes: 0 done; 1 some tasks failed, a scene has warnings, stores differ, or a self-test does
// not pass; 2 usage or experiment; 3 store; 4 coordinator out of reach; 70 a bug of ours; 130
// interrupted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace misbench {

struct Plan;

inline constexpr int kExitSomeFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;

struct ListOptions {
    std::string what;    // methods, heuristics, factors, metrics, scenes
    std::string scenes;  // folder, "" for the default
    bool json = false;
};
int list_verb(const ListOptions& options);

// What is estimated, and how, but for its budget.
struct EstimateOptions {
    std::string scene = {};   // name or path
    std::string scenes = {};  // folder, "" for the default
    std::string method = {};
    std::vector<std::string> parameters = {};  // KEY=VALUE
    std::int64_t seed = 1;
    std::string size = {};  // empty: what the scene file asks for, else 640x480
    int threads = 1;
};

struct RenderOptions {
    EstimateOptions estimate{.method = "path"};
    std::optional<std::int64_t> samples;  // exactly one of samples and seconds
    std::optional<double> seconds;
    std::string clock = "cpu";
    std::string output;  // .exr or .png
    double exposure = 0;
    std::string techniques;  // .exr or .png, "" for none; only with samples
    std::string factors;     // .exr, "" for none
    bool json = false;
};
int render_verb(const RenderOptions& options);

struct ReplayOptions {
    std::string run;    // its id or the beginning of it; "" for the estimate
    std::string store;  // of the run
    // Of a run: where its scene lies now, "" for where it was.
    EstimateOptions estimate;
    std::string pixel;  // "x,y"; "" for the run's first bad sample
    std::optional<std::int64_t> sample;
    bool json = false;
};
int replay_verb(const ReplayOptions& options);

struct SceneOptions {
    std::string scene;  // name or path; "" for all of the folder (info only)
    std::string scenes;
    int threads = 1;
    bool json = false;
};
int scene_info_verb(const SceneOptions& options);
// Returns kExitSomeFailed where there are warnings.
int scene_check_verb(const SceneOptions& options);

// What changes an experiment file, and where its scenes are.
struct ExperimentOptions {
    std::string profile;                 // "" for the first
    std::vector<std::string> overrides;  // PATH=VALUE
    std::string scenes;
};

struct PlanOptions {
    std::string file;
    ExperimentOptions experiment;
    std::string store;  // "" for none
    bool json = false;
};
int plan_verb(const PlanOptions& options);

struct RunOptions {
    std::vector<std::string> files;  // one after the other; those of `misbench lab` are passed over
    ExperimentOptions experiment;
    std::string store;
    int workers = 1;
    int threads_per_worker = 1;
    std::string progress = "auto";  // auto, always, never
    std::string command_line;       // how to resume
};
int run_verb(const RunOptions& options);

struct TableOptions {
    std::string store;
    std::vector<std::string> experiments;  // none for the latest
    std::vector<std::string> metrics;      // none for the experiment's first
    std::string rows = "scene";
    std::string columns = "method";
    std::string where;     // a Filter, "" for all
    std::string ratio_to;  // "" for the experiment's baseline, a label, best or none
    std::string sort;      // "", name, mean or a column
    bool mean = false;     // also means over scenes
    bool group = false;    // the same by the beginning of their names
    std::vector<std::string> hidden;
    std::optional<int> digits;
    std::string format = "text";  // text, csv, json, latex, latex-macros, markdown, html
};
int table_verb(const TableOptions& options);

struct SqlOptions {
    std::string store;
    std::string query;            // "" prints what there is to ask
    std::string format = "text";  // text, csv, json, markdown
};
int sql_verb(const SqlOptions& options);

struct ClaimsOptions {
    std::string store;
    std::string experiment;       // "" for all
    std::string format = "text";  // text, csv, json, markdown
};
// What claims come to is a finding, never an error.
int claims_verb(const ClaimsOptions& options);

struct BiasVerbOptions {
    std::string store;
    std::string experiment;  // "" for the latest
    std::string against;     // a label, "" for the baseline
    std::string budget;      // "" for the last
    double margin = 0.01;
    double alpha = 0.01;
    std::string format = "text";  // text, csv, json, markdown
    std::string maps;             // folder, "" for none
};
// A bias is a finding, never an error.
int bias_verb(const BiasVerbOptions& options);

struct SelfTestOptions {
    std::string store;
    std::string experiment;
    std::string metric;  // "" for the experiment's first
};
// Returns kExitSomeFailed where the comparison does not pass, or nothing could be tested.
int selftest_verb(const SelfTestOptions& options);

struct ReportOptions {
    std::string store;
    std::string experiment;
    std::string output;           // "" for STORE/report.html
    std::string seeds = "first";  // none, first, all
    bool full_precision = false;
    bool watch = false;
    double interval_seconds = 5;  // of watching
};
int report_verb(const ReportOptions& options);

struct ReferenceOptions {
    RunOptions run;                       // its store, and how to render there
    std::string experiment;               // "" for the latest
    std::optional<std::int64_t> improve;  // absent: only say how noisy the references are
    bool all = false;                     // improve all, not only the noisy ones
};
int reference_verb(const ReferenceOptions& options);

struct TradeoffOptions {
    std::string store;
    std::string experiment;  // "" for the latest
    std::string x = "cost";  // cost, wall, passes or a parameter
    std::string y;           // "" for the experiment's first metric
    std::string scene;       // "" for all
    std::string against;     // "" for the experiment's baseline
    std::optional<double> target;
    std::string format = "text";  // text, csv, json, markdown
};
int tradeoff_verb(const TradeoffOptions& options);

struct FigureOptions {
    std::string file;
    std::string store;
    std::string experiment;  // of all panels; "" for what the file says
    std::string output;      // its extension is the format
};
int figure_verb(const FigureOptions& options);

struct StoreOptions {
    std::string store;
};
int reindex_verb(const StoreOptions& options);
int status_verb(const StoreOptions& options);

struct CompareOptions {
    std::vector<std::string> images;
    std::string reference;
    std::string reference_b;           // its other half, "" for none
    std::vector<std::string> metrics;  // ids; empty for a choice of them
    std::string format = "text";       // text, csv, json, markdown
    std::string map;                   // .exr or .png, "" for none; only of one image by one metric
    std::string layer;                 // of EXR files, "" for channels without one
};
int compare_verb(const CompareOptions& options);
// Texts as they were written: fields of image_list.h, "" where not given.
struct ImportOptions {
    std::string store;
    std::string experiment;
    std::vector<std::string> images;      // files, or the folder of `pattern`
    std::vector<std::string> references;  // files
    std::string pattern;
    std::string list;  // CSV
    std::string scene;
    std::string method;
    std::int64_t seed = 1;  // of the first of `images`
    std::string samples;
    std::string seconds;
    std::string clock;
    std::string budget;
    std::string passes;
    std::string renderer;
    std::string layer;                    // of EXR files, "" for channels without one
    std::vector<std::string> parameters;  // KEY=VALUE
    std::vector<std::string> metrics;
    std::string baseline;
    bool replace = false;
    bool one_reference = false;
    std::string remove;  // a method
};
int import_verb(const ImportOptions& options);

struct DiffOptions {
    std::string a;  // stores
    std::string b;
    std::string experiment;  // "" for all that are in both
    std::string metric;      // "" for each experiment's first
    bool json = false;
};
// Returns 1 where they differ.
int diff_verb(const DiffOptions& options);

struct ExplainOptions {
    std::string store;
    std::string run;   // its id or the beginning of it; "" for `file`
    std::string file;  // an experiment's
    ExperimentOptions experiment;
    // Of the experiment's cells those with this scene, label and seed; "" for all.
    std::string scene;
    std::string method;
    std::optional<std::int64_t> seed;
};
int explain_verb(const ExplainOptions& options);

struct ExportOptions {
    std::string store;
    std::string experiment;  // "" for the latest
    std::string images;      // folder
    std::string format = "exr";
    std::string what = "all";  // runs, means, references, all
};
int export_verb(const ExportOptions& options);

struct MergeOptions {
    std::string store;  // to merge into
    std::vector<std::string> from;
    bool rename = false;
};
int merge_verb(const MergeOptions& options);

struct LabOptions {
    std::string file;
    std::vector<std::string> overrides;  // PATH=VALUE
    std::string output;                  // .svg, "" for none
    std::string format = "text";         // text, json, csv
};
int lab_verb(const LabOptions& options);

}  // namespace misbench
