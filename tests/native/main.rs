//! Native tests: one binary, a module per question.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod annotator;
mod batches;
mod bop_folder;
mod chrome;
mod cli;
mod damaged_files;
mod dataset_dialog;
mod datasets;
mod demo_scene;
mod documents;
mod evaluate;
mod export;
mod export_dialog;
mod focal;
mod gestures;
mod ghosts;
mod gpu_and_cpu;
mod images_corpus;
mod latex;
mod layers;
mod linemod;
mod looks;
mod mesh_corpus;
mod mesh_units;
mod opening;
mod panels;
mod program;
mod report;
mod report_dialog;
mod report_study;
mod scene_view;
mod scenes;
mod scenes_dialog;
mod scripts;
mod shaders;
mod storage;
mod studies;
mod study_flow;
mod study_screens;
mod support;
mod sureness;
mod symmetry;

use support::data_folder;
