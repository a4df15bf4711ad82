//! The study of the paper that this program follows, as a protocol for anybody's photographs.

use super::{
    Condition, Item, ItemKind, Questionnaire, QuestionnaireKind, QuestionnaireTime, Schedule, StartPose,
    Study, Texts, Tool, TrialOrder,
};

/// A study of no samples yet: every sample three times, in a new order each time, from R = I a metre before the camera, posed by
/// hand; the participants' expertise is asked for, and NASA-TLX and SUS at the end. The paper trained its participants in person: what
/// they were told is here a page of instructions.
pub fn paper_study(id: &str, title: &str) -> Study {
    let mut study = Study::new(id, title);
    study.conditions = vec![by_hand()];
    study.texts =
        Texts { instructions: INSTRUCTIONS.to_owned(), thanks: THANKS.to_owned(), ..Texts::default() };
    study.schedule = Schedule { repeats: 3, order: TrialOrder::ShuffledEachRepeat, seed: None };
    study.start_pose = StartPose::default();
    study.items_before = vec![choice(
        "expertise",
        "How much experience do you have with 6D object poses or 3D graphics?",
        &["none", "some", "expert"],
    )];
    study.questionnaires = vec![
        questionnaire("tlx", QuestionnaireKind::NasaTlx { weighted: false }),
        questionnaire("sus", QuestionnaireKind::Sus),
    ];
    study
}

const INSTRUCTIONS: &str = "\
# What to do

You see a photograph and a 3D model of one object in it. Move and turn the model until it covers the object as exactly as you \
can, then press Enter. You will see each photograph three times.

- **Drag** the model to move it, **drag with the right button** to turn it.
- **Shift and the wheel** bring it nearer or take it farther. **Alt** makes everything ten times finer.
- The wheel alone zooms. `?` lists all gestures and keys.

Your time is taken while a photograph is shown. Take a rest between two of them, or press *Pause*.
";

const THANKS: &str = "Thank you for taking part.\n";

/// As in the paper: the hand and the eye, without solvers.
fn by_hand() -> Condition {
    let mut condition = Condition::with_every_tool();
    (condition.id, condition.title) = ("by-hand".to_owned(), "By hand".to_owned());
    condition.tools.retain(|tool| !matches!(tool, Tool::Pins | Tool::Snap));
    condition
}

fn choice(id: &str, text: &str, options: &[&str]) -> Item {
    let options = options.iter().map(|option| (*option).to_owned()).collect();
    let answer = ItemKind::Choice { options, several: false };
    Item { id: id.to_owned(), text: text.to_owned(), optional: false, answer }
}

fn questionnaire(id: &str, kind: QuestionnaireKind) -> Questionnaire {
    Questionnaire { id: id.to_owned(), when: QuestionnaireTime::End, kind }
}
