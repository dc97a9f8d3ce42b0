C     Shear building with a rocking wall at its roof, in the style of an
C     older structural code: fixed form, sizes and arrays as arguments,
C     Newmark's average acceleration, band matrices and LAPACK's DGBSV.
C     The wall is an element: force and tangents at the roof, impacts,
C     rest and lift-off located inside the step.
C
C     With one storey the kernel solves the same problem; the program
C     prints the difference for shrinking steps and fails unless it
C     falls with the square of the step.
      program shear
      use rwmf, only: case_t, create_element, error_t, read_case_text,
     &   wall_element_t
      implicit none
      integer i, nimp
      double precision dt, err, last, umax
      type(case_t) cas
      type(wall_element_t) elem
      type(error_t), allocatable :: error
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: text =
     &   '&wall h=2.0, b=0.5, m_w=2.0e4 /'//nl//
     &   '&frame T_s=0.8, gamma=5.0, xi_s=0.05 /'//nl//
     &   '&cable eta_0=1.0, eta_alpha=5.0 /'//nl//
     &   '&impact rule="constant", e=0.9 /'//nl//
     &   '&model formulation="exact" /'//nl//
     &   '&solver method="dop853", t_end=1.0 /'
      call read_case_text(text, '', cas, error)
      if (.not. allocated(error)) then
         call create_element(elem, cas, error)
      end if
      if (allocated(error)) stop 1

      print '(2a)', ' one storey: step, largest difference',
     &   ' from the kernel'
      dt = 0.004d0
      last = 0d0
      do 10 i = 1, 4
         call onest(elem, cas, dt, err)
         print '(f10.6, es12.3)', dt, err
         if (i .gt. 1 .and. err .gt. 0.4d0*last) stop 2
         last = err
         dt = dt/2
   10 continue
      if (err .gt. 1d-5) stop 3

      call manyst(elem, 5, 0.002d0, umax, nimp)
      print '(a, f9.6, a, i0, a)', ' five storeys: roof ', umax,
     &   ' m, ', nimp, ' impacts'
      end

C     Ground acceleration [m/s2]: straight lines, knots at 0.02 s.
      double precision function ground(t)
      implicit none
      double precision t, h, x, g0, g1
      parameter (h = 0.02d0)
      x = t/h
      g0 = 5d0*sin(7d0*aint(x + 1d-9)*h)
      g1 = 5d0*sin(7d0*(aint(x + 1d-9) + 1d0)*h)
      if (aint(x + 1d-9)*h .gt. 2.999d0) g0 = 0d0
      if ((aint(x + 1d-9) + 1d0)*h .gt. 2.999d0) g1 = 0d0
      ground = g0 + (g1 - g0)*max(0d0, x - aint(x + 1d-9))
      end

C     One storey against the kernel: largest difference of the
C     displacement, looked at every 0.02 s [m].
      subroutine onest(elem, cas, dt, err)
      use rwmf, only: advance_stepping, case_t, create_stepping,
     &   destroy_stepping, error_t, query_state, stepping_t,
     &   wall_element_t, wall_state_t
      implicit none
      type(wall_element_t) elem
      type(case_t) cas
      double precision dt, err
      integer i, j, nsub, side, nimp
      double precision t, u(1), v(1), a(1), m(1), ck(4,1), sk(4,1)
      double precision om, ag0, ag1, ground
      type(stepping_t) wall
      type(wall_state_t) state
      type(error_t), allocatable :: error
      external ground
      om = 2d0*acos(-1d0)/0.8d0
      m(1) = 5d0*2.0d4
      call zero(4, 1, ck)
      call zero(4, 1, sk)
      sk(3,1) = om**2*m(1)
      ck(3,1) = 2d0*0.05d0*om*m(1)
      u(1) = 0d0
      v(1) = 0d0
      a(1) = 0d0
      side = 0
      nimp = 0
      nsub = nint(0.02d0/dt)
      err = 0d0
      call create_stepping(wall, cas, error)
      do 20 i = 1, 200
         do 10 j = 1, nsub
            t = (i - 1)*0.02d0 + (j - 1)*dt
            ag0 = ground(t)
            ag1 = ground(t + dt)
            call tstep(1, m, ck, sk, elem, dt, ag0, ag1, side, u, v, a,
     &         nimp)
   10    continue
         call advance_stepping(wall, [(i - 1)*0.02d0, i*0.02d0],
     &      [ground((i - 1)*0.02d0), ground(i*0.02d0)], error)
         if (allocated(error)) stop 4
         call query_state(wall, state, error)
         err = max(err, abs(u(1) - state%u_s))
   20 continue
      call destroy_stepping(wall)
      end

C     N equal storeys; returns the largest roof displacement [m].
      subroutine manyst(elem, n, dt, umax, nimp)
      use rwmf, only: wall_element_t
      implicit none
      type(wall_element_t) elem
      integer n, nimp
      double precision dt, umax
      integer i, side
      double precision m(n), ck(4,n), sk(4,n), u(n), v(n), a(n)
      double precision k, ground
      external ground
      k = 6d7
      call zero(4, n, ck)
      call zero(4, n, sk)
      do 10 i = 1, n
         m(i) = 2.0d4
         sk(3,i) = 2d0*k
         if (i .eq. n) sk(3,i) = k
         if (i .gt. 1) sk(2,i) = -k
         if (i .lt. n) sk(4,i) = -k
         u(i) = 0d0
         v(i) = 0d0
         a(i) = 0d0
   10 continue
C     damping proportional to stiffness
      do 20 i = 1, n
         ck(2,i) = 0.004d0*sk(2,i)
         ck(3,i) = 0.004d0*sk(3,i)
         ck(4,i) = 0.004d0*sk(4,i)
   20 continue
      side = 0
      nimp = 0
      umax = 0d0
      do 30 i = 1, nint(4d0/dt)
         call tstep(n, m, ck, sk, elem, dt, ground((i - 1)*dt),
     &      ground(i*dt), side, u, v, a, nimp)
         umax = max(umax, abs(u(n)))
   30 continue
      end

C     One time step of the building, cut at impacts and lift-off of the
C     wall. CK, SK: damping and stiffness in LAPACK's band storage
C     (one diagonal on either side). SIDE: 0 at rest, else +1 or -1.
      subroutine tstep(n, m, ck, sk, elem, dt, ag0, ag1, side, u, v, a,
     &   nimp)
      use rwmf, only: next_impact, next_lift_off, settles,
     &   velocity_factor, wall_element_t
      implicit none
      integer n, side, nimp
      type(wall_element_t) elem
      double precision m(n), ck(4,n), sk(4,n), u(n), v(n), a(n)
      double precision dt, ag0, ag1
      integer new, cuts
      logical hit
      double precision u1(n), v1(n), a1(n), q0, q1, done, h, tau, g0, g1
      done = 0d0
      do 10 cuts = 1, 10000
         h = dt - done
         if (h .le. 1d-12*dt) return
         g0 = ag0 + (ag1 - ag0)*done/dt
         g1 = ag1
         call newmrk(n, m, ck, sk, elem, h, g1, side, u, v, a,
     &      u1, v1, a1)
         hit = .false.
         new = 0
         tau = h
         if (side .eq. 0) then
            call push(n, m, ck, sk, u, v, g0, q0)
            call push(n, m, ck, sk, u1, v1, g1, q1)
            call next_lift_off(elem, h, q0, q1, g0, g1, new, tau)
         else
            call next_impact(side, h, u(n), v(n), u1(n), v1(n), hit,
     &         tau)
         end if
         if ((hit .or. new .ne. 0) .and. tau .gt. 0d0) then
            g1 = g0 + (ag1 - ag0)*tau/dt
            call newmrk(n, m, ck, sk, elem, tau, g1, side, u, v, a,
     &         u1, v1, a1)
         else if (hit .or. new .ne. 0) then
            g1 = g0
            call copy(n, u, u1)
            call copy(n, v, v1)
            call copy(n, a, a1)
         end if
         call copy(n, u1, u)
         call copy(n, v1, v)
         call copy(n, a1, a)
         done = done + tau
         if (hit) then
            nimp = nimp + 1
            u(n) = 0d0
            v(n) = velocity_factor(elem)*v(n)
            side = -side
            call push(n, m, ck, sk, u, v, g1, q1)
            if (settles(elem, dt, v(n), q1, g1, m(n))) then
               side = 0
               v(n) = 0d0
            end if
         else if (new .ne. 0) then
            side = new
         end if
         if (hit .or. new .ne. 0) then
            call accel(n, m, ck, sk, elem, g1, side, u, v, a)
         end if
   10 continue
      stop 5
      end

C     Newmark's average acceleration with Newton's iteration.
      subroutine newmrk(n, m, ck, sk, elem, h, ag, side, u0, v0, a0,
     &   u, v, a)
      use rwmf, only: element_response_t, error_t, respond,
     &   wall_element_t
      implicit none
      integer n, side
      type(wall_element_t) elem
      double precision m(n), ck(4,n), sk(4,n), h, ag
      double precision u0(n), v0(n), a0(n), u(n), v(n), a(n)
      integer i, it, info, ipiv(n)
      double precision ab(4,n), r(n), fd(n), fs(n), big
      type(element_response_t) resp
      type(error_t), allocatable :: error
      call copy(n, u0, u)
      if (side .eq. 0) u(n) = 0d0
      do 40 it = 1, 30
         do 10 i = 1, n
            a(i) = 4d0/h*((u(i) - u0(i))/h - v0(i)) - a0(i)
            v(i) = 2d0/h*(u(i) - u0(i)) - v0(i)
   10    continue
         if (side .eq. 0) then
            v(n) = 0d0
            a(n) = 0d0
         end if
         call band(n, ck, v, fd)
         call band(n, sk, u, fs)
         do 20 i = 1, n
            r(i) = -m(i)*(a(i) + ag) - fd(i) - fs(i)
            ab(1,i) = 0d0
            ab(2,i) = 2d0/h*ck(2,i) + sk(2,i)
            ab(3,i) = 4d0/h**2*m(i) + 2d0/h*ck(3,i) + sk(3,i)
            ab(4,i) = 2d0/h*ck(4,i) + sk(4,i)
   20    continue
         if (side .eq. 0) then
C           the resting wall holds the roof
            r(n) = 0d0
            ab(3,n) = 1d0
            if (n .gt. 1) ab(4,n-1) = 0d0
         else
            call respond(elem, side, u(n), v(n), a(n), ag, resp, error)
            if (allocated(error)) stop 6
            r(n) = r(n) - resp%force
            ab(3,n) = ab(3,n) + 4d0/h**2*resp%mass
     &         + 2d0/h*resp%damping + resp%stiffness
         end if
         call dgbsv(n, 1, 1, 1, ab, 4, ipiv, r, n, info)
         if (info .ne. 0) stop 7
         big = 0d0
         do 30 i = 1, n
            u(i) = u(i) + r(i)
            big = max(big, abs(r(i)))
   30    continue
         if (big .le. 1d-15) goto 50
   40 continue
   50 continue
      do 60 i = 1, n
         a(i) = 4d0/h*((u(i) - u0(i))/h - v0(i)) - a0(i)
         v(i) = 2d0/h*(u(i) - u0(i)) - v0(i)
   60 continue
      if (side .eq. 0) then
         v(n) = 0d0
         a(n) = 0d0
      end if
      end

C     Acceleration of the roof after an impact or lift-off.
      subroutine accel(n, m, ck, sk, elem, ag, side, u, v, a)
      use rwmf, only: element_response_t, error_t, respond,
     &   wall_element_t
      implicit none
      integer n, side
      type(wall_element_t) elem
      double precision m(n), ck(4,n), sk(4,n), ag, u(n), v(n), a(n)
      integer i
      double precision fd(n), fs(n)
      type(element_response_t) resp
      type(error_t), allocatable :: error
      call band(n, ck, v, fd)
      call band(n, sk, u, fs)
      do 10 i = 1, n
         a(i) = -ag - (fd(i) + fs(i))/m(i)
   10 continue
      if (side .eq. 0) then
         a(n) = 0d0
         return
      end if
      call respond(elem, side, u(n), v(n), 0d0, ag, resp, error)
      if (allocated(error)) stop 8
      a(n) = -(m(n)*ag + fd(n) + fs(n) + resp%force)/(m(n) + resp%mass)
      end

C     Force of the building on the resting wall.
      subroutine push(n, m, ck, sk, u, v, ag, q)
      implicit none
      integer n
      double precision m(n), ck(4,n), sk(4,n), u(n), v(n), ag, q
      double precision fd(n), fs(n), w(n)
      call copy(n, v, w)
C     the damper sees the roof at rest
      w(n) = 0d0
      call band(n, ck, w, fd)
      call band(n, sk, u, fs)
      q = -m(n)*ag - fd(n) - fs(n)
      end

C     Y = band matrix times X.
      subroutine band(n, ab, x, y)
      implicit none
      integer n, i
      double precision ab(4,n), x(n), y(n)
      do 10 i = 1, n
         y(i) = ab(3,i)*x(i)
   10 continue
      do 20 i = 2, n
         y(i) = y(i) + ab(4,i-1)*x(i-1)
         y(i-1) = y(i-1) + ab(2,i)*x(i)
   20 continue
      end

      subroutine copy(n, x, y)
      implicit none
      integer n, i
      double precision x(n), y(n)
      do 10 i = 1, n
         y(i) = x(i)
   10 continue
      end

      subroutine zero(n, k, x)
      implicit none
      integer n, k, i, j
      double precision x(n,k)
      do 20 j = 1, k
         do 10 i = 1, n
            x(i,j) = 0d0
   10    continue
   20 continue
      end
