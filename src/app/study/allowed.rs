//! Which commands a condition allows. What is not named here is refused, so that a command that is added later is too.

use crate::session::{Command, CommandId, Session};
use crate::study::Tool;

/// What becomes of a participant's command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    Allowed,
    /// A step of a gesture that was refused before, or nothing worth saying.
    Ignored,
    /// What it was, in words.
    Refused(&'static str),
}

/// `by_handle`: a drag that began at one of the object's handles.
pub fn verdict(command: &Command, tools: &[Tool], session: &Session, by_handle: bool) -> Verdict {
    let needs = |tool: Tool, what: &'static str| match tools.contains(&tool) {
        true => Verdict::Allowed,
        false => Verdict::Refused(what),
    };
    match command {
        Command::Run(id) => verdict_of_entry(*id, tools),
        Command::BeginGesture(_) if by_handle => needs(Tool::Handles, "dragging a handle"),
        Command::BeginGesture("Move" | "Change depth") | Command::Step { .. } => needs(Tool::Move, "moving"),
        Command::BeginGesture("Rotate") => needs(Tool::Rotate, "turning"),
        Command::Drag { .. } | Command::DragPin { .. } if !session.gesture_under_way() => Verdict::Ignored,
        Command::BeginGesture("Add pin" | "Drag pin")
        | Command::AddPin { .. }
        | Command::BeginPin(_)
        | Command::CompletePin { .. }
        | Command::EditPins(_) => needs(Tool::Pins, "setting pins"),
        Command::Nudge(..) | Command::SetNudge(_) => needs(Tool::Nudge, "moving by keys"),
        Command::SetPoseFromText(_) => needs(Tool::Numbers, "setting a pose by numbers"),
        Command::TakeSnap { .. } | Command::NoteSnap { .. } => needs(Tool::Snap, "snap"),
        Command::SetLook(_) => needs(Tool::Looks, "another look"),
        Command::SetPanes(_) => needs(Tool::SceneView, "another view"),
        Command::Drag { .. }
        | Command::DragPin { .. }
        | Command::EndGesture
        | Command::CancelGesture
        | Command::Select(Some(_)) => Verdict::Allowed,
        // There is one object, and it stays in the hand.
        Command::Select(None) | Command::SelectAlso(_) => Verdict::Ignored,
        _ => Verdict::Refused("this"),
    }
}

fn verdict_of_entry(id: CommandId, tools: &[Tool]) -> Verdict {
    let Some(tool) = tool_of(id) else {
        return match id {
            CommandId::ZoomToObject | CommandId::FitPhoto | CommandId::Cancel | CommandId::Select1 => {
                Verdict::Allowed
            }
            _ => Verdict::Refused(id.info().text),
        };
    };
    match tools.contains(&tool) {
        true => Verdict::Allowed,
        false => Verdict::Refused(id.info().text),
    }
}

/// The tool that an entry of the command table is a part of.
pub(super) fn tool_of(id: CommandId) -> Option<Tool> {
    if id.nudge().is_some() {
        return Some(Tool::Nudge);
    }
    Some(match id {
        CommandId::ToggleNudgeFrame => Tool::Nudge,
        CommandId::MoveTool => Tool::Move,
        CommandId::RotateTool => Tool::Rotate,
        CommandId::PinTool | CommandId::SolvePins | CommandId::ClearPins => Tool::Pins,
        CommandId::Snap | CommandId::SnapWide => Tool::Snap,
        CommandId::CycleViews
        | CommandId::PhotoView
        | CommandId::SceneView
        | CommandId::SplitView
        | CommandId::ResetSceneView => Tool::SceneView,
        CommandId::NextOverlay
        | CommandId::ToggleOverlay
        | CommandId::NextLayers
        | CommandId::ToggleOutline
        | CommandId::ToggleXRay
        | CommandId::ToggleWipe
        | CommandId::ToggleDifference => Tool::Looks,
        CommandId::ToggleGizmo => Tool::Handles,
        CommandId::Undo | CommandId::Redo | CommandId::ResetPose => Tool::Undo,
        CommandId::PastePose => Tool::Numbers,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::scene::{ObjectId, PhotoId, PoseSource};
    use crate::session::COMMANDS;

    const EVERYTHING: &[Tool] = &Tool::ALL;

    fn of(command: &Command, tools: &[Tool]) -> Verdict {
        verdict(command, tools, &Session::default(), false)
    }

    #[test]
    fn poses_from_outside_and_files_are_refused_whatever_is_allowed() {
        let set = Command::SetPose {
            photo: PhotoId(1),
            object: ObjectId(2),
            camera_from_object: Pose::IDENTITY,
            source: PoseSource::Manual,
        };
        assert!(matches!(of(&set, EVERYTHING), Verdict::Refused(_)));
        let refused = [
            CommandId::OpenFiles,
            CommandId::ImportPoses,
            CommandId::BackToReference,
            CommandId::ExportWorkspace,
            CommandId::RemoveObject,
            CommandId::FocalFromPins,
            CommandId::TogglePalette,
        ];
        for id in refused {
            assert!(matches!(of(&Command::Run(id), EVERYTHING), Verdict::Refused(_)), "{id:?}");
        }
    }

    #[test]
    fn without_tools_nothing_changes_a_pose() {
        let allowed: Vec<&str> = COMMANDS
            .iter()
            .filter(|info| of(&Command::Run(info.id), &[]) == Verdict::Allowed)
            .map(|info| info.name)
            .collect();
        assert_eq!(allowed, ["zoom_to_object", "fit_photo", "select_1", "cancel"]);
        for label in ["Move", "Rotate", "Add pin", "Set pose"] {
            assert!(matches!(of(&Command::BeginGesture(label), &[]), Verdict::Refused(_)), "{label}");
        }
    }

    #[test]
    fn manual_work_is_told_from_pins_and_snap() {
        let manual = &[Tool::Move, Tool::Rotate];
        assert_eq!(of(&Command::BeginGesture("Move"), manual), Verdict::Allowed);
        assert_eq!(of(&Command::Run(CommandId::Snap), manual), Verdict::Refused("Snap"));
        assert_eq!(of(&Command::Run(CommandId::PinTool), manual), Verdict::Refused("Pin"));
        let handle = verdict(&Command::BeginGesture("Move"), manual, &Session::default(), true);
        assert_eq!(handle, Verdict::Refused("dragging a handle"));
    }
}
