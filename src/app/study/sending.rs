//! Results on their way to the researcher's server: three tries, each after a longer wait; then code and file are offered all the same.

use std::cell::RefCell;
use std::rc::Rc;

use super::Running;
use crate::platform::{self, Request};
use crate::study::{Participation, Saving, Step, Study, results_name};
use crate::ui::study::Sending;

/// How often it is tried.
pub const TRIES: u32 = 3;

/// Before the second and the third try.
const WAITS_MS: [f64; 2] = [2000.0, 6000.0];

/// The public service of DataPipe.
const DATA_PIPE: &str = "https://pipe.jspsych.org/api/data/";

/// Sends one participant's results.
pub struct Sender {
    saving: Saving,
    /// Nothing is sent from a preview, nor twice.
    is_on: bool,
    attempt: u32,
    next_at_ms: f64,
    reply: Rc<RefCell<Option<Result<(), String>>>>,
    is_under_way: bool,
    state: SendState,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum SendState {
    Waiting,
    Arrived,
    Failed(String),
}

impl Sender {
    pub fn new(study: &Study, is_on: bool) -> Self {
        Self {
            saving: study.saving.clone(),
            is_on,
            attempt: 0,
            next_at_ms: 0.0,
            reply: Rc::default(),
            is_under_way: false,
            state: SendState::Waiting,
        }
    }

    fn sends(&self) -> bool {
        self.is_on && self.saving != Saving::Download
    }

    /// Nothing is left to wait for.
    pub fn is_done(&self) -> bool {
        !self.sends() || self.state != SendState::Waiting
    }

    pub fn view(&self) -> Sending<'_> {
        match &self.state {
            _ if self.saving == Saving::Download => Sending::ByHand,
            _ if !self.is_on => Sending::Arrived,
            SendState::Waiting => Sending::UnderWay { attempt: self.attempt.max(1), of: TRIES },
            SendState::Arrived => Sending::Arrived,
            SendState::Failed(reason) => Sending::Failed { reason },
        }
    }

    /// From the first try again.
    pub fn try_again(&mut self) {
        self.attempt = 0;
        self.next_at_ms = 0.0;
        self.state = SendState::Waiting;
    }

    /// True when the results have just arrived.
    fn tick(&mut self, participation: &Participation, ctx: &egui::Context, now_ms: f64) -> bool {
        let reply = self.reply.borrow_mut().take();
        if let Some(reply) = reply {
            self.is_under_way = false;
            match reply {
                Ok(()) => {
                    self.state = SendState::Arrived;
                    return true;
                }
                Err(problem) => match WAITS_MS.get(self.attempt.saturating_sub(1) as usize) {
                    Some(wait_ms) => self.next_at_ms = now_ms + wait_ms,
                    None => self.state = SendState::Failed(format!("It was tried {TRIES} times: {problem}.")),
                },
            }
        }
        if self.is_done() || self.is_under_way {
            return false;
        }
        if now_ms < self.next_at_ms {
            let wait = std::time::Duration::from_secs_f64((self.next_at_ms - now_ms) / 1000.0);
            ctx.request_repaint_after(wait);
            return false;
        }
        self.attempt += 1;
        self.is_under_way = true;
        self.send(participation, ctx, now_ms);
        false
    }

    fn send(&self, participation: &Participation, ctx: &egui::Context, now_ms: f64) {
        let Some(request) = request(&self.saving, participation, now_ms) else { return };
        let (reply, ctx) = (self.reply.clone(), ctx.clone());
        platform::spawn(async move {
            *reply.borrow_mut() = Some(platform::send_request(request).await);
            ctx.request_repaint();
        });
    }
}

/// What is sent where; nothing where the participant sends the file.
fn request(saving: &Saving, participation: &Participation, now_ms: f64) -> Option<Request> {
    let results = &participation.results;
    // A later try has another time in its name: a server that took the first one half keeps both apart.
    let file = format!("{}.json", results_name(&results.study.id, &results.participant.id, now_ms));
    let body = results.to_json();
    let at = |url: &str| url.replace("{file}", &file);
    Some(match saving {
        Saving::Download => return None,
        Saving::DataPipe { experiment_id, url } => Request {
            method: "POST",
            url: url.clone().unwrap_or_else(|| DATA_PIPE.to_owned()),
            body: data_pipe_body(experiment_id, &file, &body),
        },
        Saving::Put { url } => Request { method: "PUT", url: at(url), body },
        Saving::Post { url } => Request { method: "POST", url: at(url), body },
    })
}

/// DataPipe's: the content is a text in JSON.
fn data_pipe_body(experiment: &str, file: &str, content: &str) -> String {
    crate::study::json_object(&[("experimentID", experiment), ("filename", file), ("data", content)])
}

impl Running {
    pub(super) fn tick_sending(&mut self, ctx: &egui::Context, now_ms: f64) {
        if self.step() != Step::Finish || self.participation.has_declined() {
            return;
        }
        if self.participation.results.finished_at.is_none() {
            self.participation.finish(now_ms);
            self.keeping.changed(&self.participation, now_ms);
        }
        if self.sender.tick(&self.participation, ctx, now_ms) {
            self.participation.is_saved = true;
            self.keeping.changed(&self.participation, now_ms);
        }
        self.tick_redirect(ctx, now_ms);
    }

    /// Only after the results are saved, or cannot be: and then the file has to be taken first.
    fn tick_redirect(&mut self, ctx: &egui::Context, now_ms: f64) {
        let completion = &self.ready.files.study.completion;
        if completion.redirect.is_none() || self.sender.view() != Sending::Arrived || !self.sender.is_on {
            return;
        }
        let seconds = completion.redirect_after_seconds.clamp(0.0, 3600.0);
        let at_ms = *self.redirect_at_ms.get_or_insert(now_ms + seconds * 1000.0);
        if now_ms >= at_ms {
            self.redirect_at_ms = Some(f64::INFINITY);
            self.redirect();
        } else if at_ms.is_finite() {
            ctx.request_repaint_after(std::time::Duration::from_millis(250));
        }
    }

    pub(super) fn redirect(&self) {
        if let Some(url) = self.redirect_url() {
            platform::go_to(&url);
        }
    }

    /// The address with the participant's and the recruiter's words in it; only to the web.
    fn redirect_url(&self) -> Option<String> {
        let participant = &self.participation.results.participant;
        let mut url = self.ready.files.study.completion.redirect.clone()?;
        url = url.replace("{participant}", &percent(&participant.id));
        for (name, value) in &participant.recruiter {
            url = url.replace(&format!("{{{name}}}"), &percent(value));
        }
        (url.starts_with("https://") || url.starts_with("http://")).then_some(url)
    }
}

/// As a part of an address (RFC 3986): what is not unreserved is written as its bytes.
fn percent(text: &str) -> String {
    text.bytes()
        .map(|byte| match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => {
                char::from(byte).to_string()
            }
            _ => format!("%{byte:02X}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn ids_stay_within_their_part_of_an_address() {
        assert_eq!(percent("a-1_b.c~"), "a-1_b.c~");
        assert_eq!(percent("a&b=ü"), "a%26b%3D%C3%BC");
    }
}
