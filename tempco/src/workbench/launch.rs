//! Opens the browser without telling the token to whoever lists this computer's processes.

use std::io::Write;
use tempfile::NamedTempFile;

/// Opens a file that only this user can read, which leads to the address. Where there is no browser, the address that
/// was printed will do. The file lives as long as what is returned.
pub fn browser(url: &str) -> Option<NamedTempFile> {
    let mut file = tempfile::Builder::new().prefix("tempco-workbench-").suffix(".html").tempfile().ok()?;
    let page = format!(
        "<!doctype html><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"0;url={url}\">\
         <title>tempco workbench</title><a href=\"{url}\">tempco workbench</a>"
    );
    file.write_all(page.as_bytes()).ok()?;
    open::that_detached(file.path()).ok()?;
    Some(file)
}
