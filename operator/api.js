// Requests to the server, and what it sends by itself.
const ANSWER_MS = 45000;
let token = "";
export function setToken(value) { token = value; }
let seen = 0;  // the server's stamp of the newest state that this page has shown

// The server's object; {success: false, message} when the server refuses or cannot be reached. Never throws.
export async function request(path, body) {
  const control = new AbortController();
  const timer = setTimeout(() => control.abort(), ANSWER_MS);
  try {
    const options = { signal: control.signal, credentials: "same-origin", cache: "no-store" };
    if (body !== undefined) {
      options.method = "POST";
      options.headers = { "Content-Type": "application/json", "X-CSRF-Token": token, "X-Seen": String(seen) };
      options.body = JSON.stringify(body);
    }
    const answer = await fetch(path, options);
    const content = await answer.json();
    if (answer.status === 401 && path !== "/api/login") document.dispatchEvent(new Event("logged-out"));
    return answer.ok ? content : { success: false, message: content.message || String(answer.status), status: answer.status };
  } catch (error) {
    return { success: false, message: "the server cannot be reached", lost: true };
  } finally {
    clearTimeout(timer);
  }
}

// STOP: no token, no session, no body; asked for again until somebody has answered.
export async function stop() {
  for (let attempt = 0; attempt < 5; attempt++) {
    try {
      const answer = await fetch("/api/stop", { method: "POST", credentials: "same-origin", keepalive: true });
      return await answer.json();
    } catch (error) {
      await new Promise((resume) => setTimeout(resume, 150 * (attempt + 1)));
    }
  }
  return { success: false, message: "STOP did not reach the robot's computer: use the hand switch or the emergency stop button" };
}

// Messages of the server by kind, for ever: connects again when the connection is lost. `onLost(is_lost)`.
export function listen(handlers, onLost) {
  const SILENT_MS = 2500;
  let heard = performance.now(), lost = false, socket = null, closed = false;
  const tell = (value) => { if (value !== lost) { lost = value; onLost(value); } };
  function connect() {
    if (closed) return;
    socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/live`);
    socket.onmessage = (event) => {
      heard = performance.now();
      tell(false);
      const message = JSON.parse(event.data);
      if (message.type === "state") seen = message.content.seen;
      if (handlers[message.type]) handlers[message.type](message.content);
    };
    socket.onclose = () => setTimeout(connect, 700);
  }
  const timer = setInterval(() => {
    if (performance.now() - heard > SILENT_MS) {
      tell(true);
      if (socket && socket.readyState === WebSocket.OPEN && performance.now() - heard > 2 * SILENT_MS) socket.close();
    }
  }, 250);
  connect();
  return () => { closed = true; clearInterval(timer); if (socket) socket.close(); };
}
