// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "fuse_views_input.hpp"
#include "interrupt.hpp"
#include "mixture_commands.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// An instance counts as reported in the table from this probability on.
constexpr double kTableProbability = 0.5;

struct FuseViewsOptions {
  FuseViewsInput input;
  FuseViewsSettings settings;
  double least_probability = 0.0;
  std::string out;
  bool quiet = false;
};

struct FuseViewsOutput {
  std::vector<BopRow> rows;
  Json groups = Json::array();
  std::string table = "scene_id,group,images,observations,instances,reported,supporting_views\n";
  std::size_t instances = 0;
  std::size_t reported = 0;
};

std::vector<double> pose_numbers(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json instance_json(const FusedInstance& instance, const ImageGroup& images) {
  Json json = {{"obj_id", std::stoll(instance.class_id)},
               {"probability", instance.probability},
               {"supporting_views", instance.supporting_views},
               {"support", Json::array()}};
  for (const ViewSupport& support : instance.support) {
    json["support"].push_back({{"im_id", images.images[support.view]},
                               {"observation", support.observation},
                               {"probability", support.probability}});
  }
  const MixtureFile file{{"world", "object_" + instance.class_id}, instance.density};
  json["mixture"] = Json::parse(format_mixture(file));
  return json;
}

void add_group(const ViewGroup& group, const FuseViewsJob& job, const FuseViewsOptions& options,
               FuseViewsOutput& output) {
  const ImageGroup& images = group.images;
  Json json = {{"scene_id", images.scene}, {"im_id", images.images}};
  std::size_t observations = 0;
  for (const View& view : group.views) {
    json["world_camera"].push_back(pose_numbers(view.world_camera));
    observations += view.observations.size();
  }
  json["instances"] = Json::array();
  std::size_t count = 0;
  std::size_t reported = 0;
  double support = 0.0;
  for (const FusedInstance& instance : fuse_views(group.views, job.classes, options.settings)) {
    if (instance.probability < options.least_probability) continue;
    ++count;
    if (instance.probability >= kTableProbability) {
      ++reported;
      support += instance.supporting_views;
    }
    json["instances"].push_back(instance_json(instance, images));
    for (std::size_t v = 0; v < group.views.size(); ++v) {
      output.rows.push_back(
          {images.scene, images.images[v], std::stoll(instance.class_id), instance.probability,
           group.views[v].world_camera.inverse() * instance.density[0].density.mean()});
    }
  }
  output.instances += count;
  output.reported += reported;
  output.table +=
      fmt::format("{},{},{},{},{},{},{}\n", images.scene, output.groups.size(), group.views.size(),
                  observations, count, reported,
                  reported > 0 ? fmt::format("{:.4g}", support / double(reported)) : "");
  output.groups.push_back(std::move(json));
}

int fuse_views_command(const FuseViewsOptions& options) {
  const InterruptGuard guard;
  const FuseViewsJob job = read_fuse_views_job(options.input);
  OutputFolder folder(options.out);
  folder.put_last("fused.csv");
  FuseViewsOutput output;
  for (const ViewGroup& group : job.groups) {
    try {
      add_group(group, job, options, output);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: scene {}, images {}: {}", options.input.results,
                                     group.images.scene, fmt::join(group.images.images, ", "),
                                     error.what()));
    }
    guard.check();
  }
  folder.write("fused.csv", format_bop_rows(output.rows));
  folder.write("instances.json",
               Json{{"schema", 1}, {"groups", std::move(output.groups)}}.dump() + "\n");
  folder.write("groups.csv", output.table);
  folder.commit();
  if (!options.quiet) {
    print_text(fmt::format(
        "groups:                           {}\ninstances:                        {}\n"
        "  of probability {} or more:     {}\nresults:                          {}\n",
        job.groups.size(), output.instances, kTableProbability, output.reported, options.out));
  }
  return kExitDone;
}

void add_view_options(CLI::App& command, FuseViewsInput& input) {
  command.add_option("results", input.results, "Results of single images (BOP CSV)")
      ->required()
      ->type_name("RESULTS.csv");
  auto* cameras = command.add_option_group("cameras", "Where the camera poses are from");
  cameras
      ->add_option("--dataset", input.dataset,
                   "BOP dataset: its scene_camera.json, else the poses of its scene_gt.json")
      ->type_name("DIR");
  cameras
      ->add_option("--cameras", input.cameras,
                   "CSV scene_id,im_id,tx,ty,tz,qx,qy,qz,qw: T_world_camera in metres")
      ->type_name("FILE");
  cameras
      ->add_option("--ground-truth", input.ground_truth,
                   "True poses of objects that stand still (BOP CSV)")
      ->type_name("FILE");
  cameras->require_option(1);
  command.add_option("--split", input.split, "Folder of the images in --dataset")
      ->type_name("NAME")
      ->capture_default_str();
  auto* groups = command.add_option_group("groups", "Which images are fused");
  add_integer_option(*groups, "--groups", input.group_size, {1, 1000},
                     "Groups of this many successive images of the results");
  groups->add_option("--targets", input.targets, "Multi-view targets of BOP (JSON)")
      ->type_name("FILE");
  groups->require_option(1);
}

void add_object_options(CLI::App& command, FuseViewsOptions& options) {
  FuseViewsInput& input = options.input;
  CLI::Option* models =
      command
          .add_option("--models-info", input.models_info,
                      "Symmetries by object: models_info.json of BOP, or TOML; without it that of "
                      "--dataset")
          ->type_name("FILE");
  command.add_flag("--no-symmetries", input.no_symmetries, "No object has symmetries")
      ->excludes(models);
  command
      .add_option(
          "--noise", input.noise,
          "The detector's error, a file with one table [noise.NAME]; without it the default")
      ->type_name("FILE.toml");
  add_choice<BopRowUse>(command, "--rows", input.rows.use,
                        "What the rows of one object in one image are")
      ->default_str("mixtures");
  command.add_option("--least-score", input.rows.least_score, "Rows below it are left out")
      ->check(number_in(kAnyNumber))
      ->type_name("SCORE");
  command
      .add_option("--detection-probability", options.settings.detection_probability,
                  "That an object of the scene is detected in a view")
      ->check(number_in(FuseViewsSettings::kProbability))
      ->type_name("P")
      ->capture_default_str();
  command
      .add_option("--least-probability", options.least_probability,
                  "Instances below it are left out")
      ->check(number_in(kUnitInterval))
      ->type_name("P")
      ->capture_default_str();
}

}  // namespace

void add_fuse_views_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<FuseViewsOptions>();
  CLI::App* command = program.add_subcommand(
      "fuse-views", "Poses from several images whose camera poses are known");
  command->footer(
      "Finds the objects that the detections of a group of images are of, with the modes of their\n"
      "poses, and writes into DIR: fused.csv, T_camera_object for each image of the group with "
      "the\n"
      "probability of the object as score (BOP CSV); instances.json with the mixtures over\n"
      "T_world_object and the views that agree; groups.csv.\n"
      "\n"
      "Example: posemix fuse-views single.csv --cameras cameras.csv --groups 4 --out out/fused\n"
      "         posemix fuse-views single.csv --dataset tless --targets "
      "test_targets_multiview_bop25.json -o out/fused");
  add_view_options(*command, options->input);
  add_object_options(*command, *options);
  command->add_option("-o,--out", options->out, "Folder for the results")
      ->required()
      ->type_name("DIR");
  command->add_flag("--quiet", options->quiet, "Print nothing");
  command->callback(
      [options, &action] { action = [options] { return fuse_views_command(*options); }; });
}

}  // namespace posemix
