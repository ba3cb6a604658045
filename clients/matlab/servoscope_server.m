function server = servoscope_server(url, api_key)
%SERVOSCOPE_SERVER  Tells the other functions where the server is.
%   servoscope_server(URL) uses the server at URL from now on; at first it is
%   http://127.0.0.1:8080.
%
%   servoscope_server(URL, KEY) also sends KEY as "Authorization: Bearer", for
%   a server that asks for one. Without KEY, the key in the environment
%   variable SERVOSCOPE_KEY is sent, if there is one.
%
%   S = servoscope_server() gives the present URL in S.url.
%
%   The program curl has to be installed. It is part of Windows 10 and later
%   and of macOS.
    persistent known
    if isempty(known)
        known = struct('url', 'http://127.0.0.1:8080', 'api_key', getenv('SERVOSCOPE_KEY'));
    end
    if nargin >= 1
        known.url = regexprep(char(url), '/+$', '');
        known.api_key = getenv('SERVOSCOPE_KEY');
    end
    if nargin >= 2
        known.api_key = char(api_key);
    end
    server = known;
end
