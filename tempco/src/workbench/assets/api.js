// Talks to the server. The token came behind `#` in the address; it is kept for this tab, and taken out of the address.

const KEY = "tempco-token";
const given = location.hash.slice(1);
if (/^[0-9a-f]{64}$/.test(given)) {
  sessionStorage.setItem(KEY, given);
  history.replaceState(null, "", location.pathname);
}
const token = sessionStorage.getItem(KEY) ?? "";
const headers = { "x-tempco-token": token };

// What the server said when it would not: a message, and what to do.
export class Refusal extends Error {
  constructor({ message, help }) {
    super(message);
    this.help = help;
  }
}

async function answered(response) {
  if (response.ok) return response;
  const refusal = await response.json().catch(() => ({ message: `${response.status} ${response.statusText}` }));
  throw new Refusal(refusal);
}

async function ask(path, options = {}) {
  const response = await fetch(path, { cache: "no-store", ...options, headers }).catch(() => {
    throw new Refusal({ message: "The workbench doesn't answer.", help: "Start it again:  tempco workbench" });
  });
  return answered(response);
}

export const read = async (path) => (await ask(path)).json();
export const bytes = async (path) => (await ask(path)).arrayBuffer();
const send = (path, body) => ask(path, { method: "POST", body });
// An answer that nobody reads counts as broken off.
const heard = async (response) => {
  await (await response).text();
};
export const act = (verb, request = {}) => heard(send(`/api/${verb}`, JSON.stringify(request)));
export const answer = async (verb, request) => (await send(`/api/${verb}`, JSON.stringify(request))).json();
// Files that belong together; the number of the folder that they lie in.
export async function uploadAll(files) {
  const { upload } = await answer("uploads", {});
  for (const file of files) await heard(send(`/api/upload?upload=${upload}&name=${encodeURIComponent(file.name)}`, file));
  return upload;
}

// Saves what the server sends under the name that it gives it.
export async function save(path) {
  const response = await ask(path);
  const name = /filename="(.+)"/.exec(response.headers.get("content-disposition") ?? "")?.[1] ?? "tempco";
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await response.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

// Server-sent events, read by fetch because an EventSource can't carry the token. Begins again when the line breaks.
export async function listen(onEvent, onLine) {
  for (;;) {
    try {
      const response = await ask("/api/events");
      onLine(true);
      await events(response.body.getReader(), onEvent);
    } catch {
      // The next round says whether it is back.
    }
    onLine(false);
    await new Promise((resume) => {
      setTimeout(resume, 1500);
    });
  }
}

async function events(reader, onEvent) {
  const decoder = new TextDecoder();
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    text += decoder.decode(value, { stream: true });
    const parts = text.split("\n\n");
    text = parts.pop();
    for (const part of parts) {
      const field = (name) =>
        part
          .split("\n")
          .find((line) => line.startsWith(`${name}:`))
          ?.slice(name.length + 1)
          .trim();
      if (field("event")) onEvent(field("event"), JSON.parse(field("data")));
    }
  }
}
