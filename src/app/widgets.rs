//! The interface's widgets as the page's API shows them, read from egui's AccessKit tree.

use egui::accesskit::{NodeId, Role, TreeUpdate};

use crate::platform::Widget;

/// Keeps the last tree that egui made; it makes one when it is asked to.
#[derive(Debug, Default)]
pub struct WidgetWatcher {
    tree: Option<TreeUpdate>,
}

impl egui::Plugin for WidgetWatcher {
    fn debug_name(&self) -> &'static str {
        "widget watcher"
    }

    fn output_hook(&mut self, _ctx: &egui::Context, output: &mut egui::FullOutput) {
        // The browser has no use for it, and eframe would drop it.
        if let Some(tree) = &output.platform_output.accesskit_update {
            self.tree = Some(tree.clone());
        }
    }
}

impl WidgetWatcher {
    /// The widgets of the last tree, and none of an older one the next time.
    pub fn take(&mut self) -> Option<Vec<Widget>> {
        let tree = self.tree.take()?;
        let text_of = |id: &NodeId| {
            let node = tree.nodes.iter().find(|(candidate, _)| candidate == id);
            node.and_then(|(_, node)| node.value().map(str::to_owned))
        };
        // Runs of text are parts of the labels, which are here too.
        let nodes = tree.nodes.iter().filter(|(_, node)| node.role() != Role::TextRun);
        let widgets = nodes.filter_map(|(id, node)| {
            let mut widget = widget(*id, node)?;
            if widget.label.is_empty() {
                widget.label = node.labelled_by().iter().find_map(text_of).unwrap_or_default();
            }
            Some(widget)
        });
        Some(widgets.collect())
    }
}

fn widget(id: NodeId, node: &egui::accesskit::Node) -> Option<Widget> {
    let bounds = node.bounds()?;
    let value =
        node.value().map(str::to_owned).or_else(|| node.numeric_value().map(|value| value.to_string()));
    let toggled = node.toggled().map(|toggled| format!("{toggled:?}").to_lowercase());
    let value = value.or(toggled).unwrap_or_default();
    // egui puts a label's text into its value.
    let label = match node.label() {
        Some(label) => label.to_owned(),
        None if node.role() == Role::Label => value.clone(),
        None => String::new(),
    };
    Some(Widget {
        id: id.0,
        label,
        role: format!("{:?}", node.role()),
        value,
        enabled: !node.is_disabled(),
        visible: !node.is_hidden() && bounds.area() > 0.0,
        rect: [bounds.x0, bounds.y0, bounds.width(), bounds.height()],
    })
}
