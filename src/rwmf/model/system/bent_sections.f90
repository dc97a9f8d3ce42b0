!> Section forces of a bending wall, from the balance of the part above a section
!> (docs/theory/bending.md).
!>
!> Across the straight axis the wall at height z has the acceleration
!> `push + turn z + sum(across_i phi_i)`, along it `pull + stretch z + sum(along_i phi_i)`, gravity
!> included. The shear V is the integral of the first above the section, less cable and links. With
!> the axial force N and the rotary inertia of the width, dM/dz = -V + w' N - b**2/3 theta''/(2h).
!> This slope is integrated by Gauss's rule from the top.
module rwmf_model_system_bent_sections
   use rwmf_core_kinds, only: wp
   use rwmf_math_cantilever, only: deflection, force_above, slope_of
   use rwmf_math_gauss, only: gauss_node
   use rwmf_math_roots, only: close_in, secant_between, secant_t, vertex_of_parabola
   use rwmf_model_beam, only: beam_t
   use rwmf_model_equation, only: equation_t, ground, vertical_ground
   use rwmf_model_system_reactions, only: cable_force
   use rwmf_model_system_wall_sections, only: links_t, section_extremes_t
   implicit none
   private

   public :: bent_sections_t, create_bent_sections, find_bent_sections, find_bent_extremes

   integer, parameter :: points = 5
   !! of Gauss's rule in a piece
   integer, parameter :: centre = 3
   !! the point in the middle of a piece
   integer, parameter :: per_half_wave = 8
   !! pieces in a half wave of the highest mode
   integer, parameter :: most_modes = 12

   !> Loads on the part of the wall above a section, in the axes of the wall.
   type :: bent_loads_t
      real(wp) :: push = 0, turn = 0, across(most_modes) = 0
      !! acceleration across the axis [m/s2], [1/s2], [m/s2]
      real(wp) :: pull = 0, stretch = 0, along(most_modes) = 0
      !! acceleration along the axis [m/s2], [1/s2], [m/s2]
      real(wp) :: q(most_modes) = 0
      !! deflections of the modes [m]
      real(wp) :: width = 0
      !! slope of the moment due to the rotary inertia of the width [m/s2]
      real(wp) :: force(2) = 0
      !! force of cable and links across and along the axis [m/s2]
   end type bent_loads_t

   !> Pieces between nodes along the height, and the section forces at the nodes.
   type :: bent_sections_t
      type(beam_t) :: beam
      real(wp), allocatable :: z(:)
      !! (0:n) heights of the nodes above the base [m]
      integer, allocatable :: of_floor(:)
      !! (floors) node of each floor
      integer :: middle = 0
      !! node at mid-height
      real(wp) :: share(points), weight(points)
      !! Gauss's rule on [0, 1] [-]
      real(wp), allocatable :: above(:, :), phi(:, :), tilt(:, :)
      !! (modes, 0:n) integral of each mode from a node to the top, over the height [-]; its
      !! deflection [-] and slope [1/m] at the node
      real(wp), allocatable :: slope(:, :, :), above_inside(:, :, :)
      !! (modes, points, n) slope of each mode [1/m] and its integral above, inside the pieces
      real(wp), allocatable :: phi_centre(:, :)
      !! (modes, n) deflection of each mode in the middle of a piece [-]
      real(wp), allocatable :: below_node(:, :), above_node(:, :)
      !! (2, 0:n) shear [m/s2] and moment [m2/s2] on both sides of each node
   end type bent_sections_t

contains

   !> Place the nodes: base, floors, mid-height, top, and enough between them for the highest mode.
   subroutine create_bent_sections(sections, beam, floors)
      type(bent_sections_t), intent(out) :: sections
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: floors(:)
      !! (floors) heights, ascending [m]
      real(wp) :: node
      integer :: i, j, k

      sections%beam = beam
      call place_nodes(sections, floors)
      do j = 1, points
         call gauss_node(points, j, node, sections%weight(j))
         sections%share(j) = (1 + node)/2
      end do
      sections%weight = sections%weight/2
      associate (n => ubound(sections%z, 1))
         allocate (sections%above(beam%n, 0:n), sections%slope(beam%n, points, n), &
            sections%above_inside(beam%n, points, n), sections%phi(beam%n, 0:n), &
            sections%tilt(beam%n, 0:n), sections%phi_centre(beam%n, n))
         allocate (sections%below_node(2, 0:n), sections%above_node(2, 0:n), source=0.0_wp)
         do i = 0, n
            do k = 1, beam%n
               node = sections%z(i)/beam%length
               sections%above(k, i) = force_above(beam%modes(k), node)
               sections%phi(k, i) = deflection(beam%modes(k), node)
               sections%tilt(k, i) = slope_of(beam%modes(k), node)/beam%length
               if (i == 0) cycle
               sections%phi_centre(k, i) = deflection(beam%modes(k), (sections%z(i - 1) &
                  + sections%z(i))/2/beam%length)
               do j = 1, points
                  node = (sections%z(i - 1) + sections%share(j)*(sections%z(i) &
                     - sections%z(i - 1)))/beam%length
                  sections%slope(k, j, i) = slope_of(beam%modes(k), node)/beam%length
                  sections%above_inside(k, j, i) = force_above(beam%modes(k), node)
               end do
            end do
         end do
      end associate
   end subroutine create_bent_sections

   !> Choose the heights of the nodes.
   subroutine place_nodes(sections, floors)
      type(bent_sections_t), intent(inout) :: sections
      real(wp), intent(in) :: floors(:)
      real(wp), parameter :: same = 1.0e-9_wp
      !! distance of a floor from mid-height or top, over the height [-]
      real(wp), allocatable :: ends(:), z(:)
      integer :: i, j, n

      associate (length => sections%beam%length, modes => sections%beam%n)
         ends = pack(floors, abs(floors - length) > same*length)
         if (.not. any(abs(ends - length/2) <= same*length)) then
            n = count(ends < length/2)
            ends = [ends(:n), length/2, ends(n + 1:)]
         end if
         ends = [ends, length]
         allocate (z(1), source=0.0_wp)
         allocate (sections%of_floor(size(floors)))
         do i = 1, size(ends)
            associate (low => z(size(z)))
               n = max(1, ceiling((ends(i) - low)/length*per_half_wave*modes))
               z = [z, (low + (ends(i) - low)*j/n, j=1, n - 1), ends(i)]
            end associate
            if (abs(ends(i) - length/2) <= same*length) sections%middle = size(z) - 1
            where (abs(floors - ends(i)) <= same*length) sections%of_floor = size(z) - 1
         end do
         allocate (sections%z(0:size(z) - 1))
         sections%z(:) = z
      end associate
   end subroutine place_nodes

   !> Compute shear and moment on both sides of every node.
   subroutine find_bent_sections(sections, equation, t, y, y_dot, links)
      type(bent_sections_t), intent(inout) :: sections
      type(equation_t), intent(in) :: equation
      !! with `&bending`
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates
      type(links_t), intent(in) :: links
      type(bent_loads_t) :: loads

      call integrate(sections, equation, t, y, y_dot, links, loads)
   end subroutine find_bent_sections

   !> Find the largest shear and the largest moment along the height.
   subroutine find_bent_extremes(sections, equation, t, y, y_dot, links, extremes)
      type(bent_sections_t), intent(inout) :: sections
      type(equation_t), intent(in) :: equation
      !! with `&bending`
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates
      type(links_t), intent(in) :: links
      type(section_extremes_t), intent(out) :: extremes
      type(bent_loads_t) :: loads

      call integrate(sections, equation, t, y, y_dot, links, loads, extremes)
   end subroutine find_bent_extremes

   !> Go down the wall from piece to piece. If extrema are wanted, inspect the pieces that may hold
   !> more than all nodes.
   subroutine integrate(sections, equation, t, y, y_dot, links, loads, extremes)
      type(bent_sections_t), intent(inout) :: sections
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:), y_dot(:)
      type(links_t), intent(in) :: links
      type(bent_loads_t), intent(out) :: loads
      type(section_extremes_t), intent(inout), optional :: extremes
      real(wp), parameter :: same = 1.0e-9_wp
      !! distance of a link from its node, over the length [-]
      real(wp) :: moment, force(2, ubound(sections%z, 1))
      !! moment; force of cable and links above each piece
      integer :: i, link

      call find_loads(sections%beam, equation, t, y, y_dot, loads)
      link = size(links%force, 2)
      moment = 0
      do i = ubound(sections%z, 1), 0, -1
         sections%above_node(:, i) = [shear_at_node(sections, loads, i), moment]
         if (link > 0) then
            if (abs(sections%z(i) - links%place(2, link)) <= same*sections%beam%length) then
               call add_link(sections%beam, loads, links, link, y(1), moment)
               link = link - 1
            end if
         end if
         sections%below_node(:, i) = [shear_at_node(sections, loads, i), moment]
         if (i > 0) then
            moment = moment - moment_gain(sections, loads, i)
            force(:, i) = loads%force
         end if
         if (present(extremes)) call inspect_node(i)
      end do
      if (.not. present(extremes)) return
      do i = ubound(sections%z, 1), 1, -1
         loads%force = force(:, i)
         call inspect_piece(sections, loads, i, extremes)
      end do

   contains

      !> Include both sides of a node in the search.
      subroutine inspect_node(i)
         integer, intent(in) :: i

         associate (force => max(abs(sections%below_node(:, i)), abs(sections%above_node(:, i))))
            if (force(1) > extremes%shear) then
               extremes%shear = force(1)
               extremes%z_shear = sections%z(i)
            end if
            if (force(2) > extremes%moment) then
               extremes%moment = force(2)
               extremes%z_moment = sections%z(i)
            end if
         end associate
      end subroutine inspect_node
   end subroutine integrate

   !> Collect the loads at the top.
   subroutine find_loads(beam, equation, t, y, y_dot, loads)
      type(beam_t), intent(in) :: beam
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:), y_dot(:)
      type(bent_loads_t), intent(out) :: loads
      real(wp) :: g, a, arm, sine, cosine
      real(wp) :: cable(2)

      sine = sin(y(1))
      cosine = cos(y(1))
      g = equation%p%g
      if (equation%has_vertical) g = g + vertical_ground(equation, t)
      a = ground(equation, t)
      arm = equation%state%side*beam%half_width
      loads%push = a*cosine - g*sine + arm*y(2)**2
      loads%turn = y_dot(2)
      loads%pull = a*sine + g*cosine + arm*y_dot(2)
      loads%stretch = -y(2)**2
      associate (n => beam%n, first => beam%first)
         associate (q => y(first:first + n - 1), q_dot => y(first + n:first + 2*n - 1), &
                    q_ddot => y_dot(first + n:first + 2*n - 1))
            loads%q(:n) = q
            loads%across(:n) = q_ddot - q*y(2)**2
            loads%along(:n) = -(2*q_dot*y(2) + q*y_dot(2))
         end associate
      end associate
      loads%width = -beam%half_width**2/3*y_dot(2)/beam%length
      ! the duct carries the axial force of the cable through the centre of every section
      cable = cable_force(equation, y(1))
      loads%force(1) = cosine*cable(1) - sine*cable(2)
   end subroutine find_loads

   !> Add the force of a link to the loads above the section.
   pure subroutine add_link(beam, loads, links, i, theta, moment)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(inout) :: loads
      type(links_t), intent(in) :: links
      integer, intent(in) :: i
      !! number of the link
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp), intent(inout) :: moment
      !! [m2/s2]
      real(wp) :: force(2), w
      integer :: k

      force = [cos(theta)*links%force(1, i) - sin(theta)*links%force(2, i), &
         sin(theta)*links%force(1, i) + cos(theta)*links%force(2, i)]
      loads%force = loads%force + force
      w = 0
      do k = 1, beam%n
         w = w + loads%q(k)*deflection(beam%modes(k), links%place(2, i)/beam%length)
      end do
      moment = moment + (links%place(1, i) - w)*force(2)
   end subroutine add_link

   !> Shear at a node [m/s2].
   pure real(wp) function shear_at_node(sections, loads, i) result(shear)
      type(bent_sections_t), intent(in) :: sections
      type(bent_loads_t), intent(in) :: loads
      integer, intent(in) :: i

      shear = straight_part(loads%push, loads%turn, sections%z(i), sections%beam%length) &
         + dot_product(loads%across(:sections%beam%n), sections%above(:, i)) - loads%force(1)
   end function shear_at_node

   !> Integral of an acceleration linear in z from a section to the top, over the height [m/s2].
   pure real(wp) function straight_part(constant, slope, z, length) result(total)
      real(wp), intent(in) :: constant
      !! at the base [m/s2]
      real(wp), intent(in) :: slope
      !! [1/s2]
      real(wp), intent(in) :: z, length
      !! [m]

      total = (constant + slope*(length + z)/2)*(length - z)/length
   end function straight_part

   !> Growth of the moment over a piece, from its lower to its upper end [m2/s2].
   pure real(wp) function moment_gain(sections, loads, i) result(gain)
      type(bent_sections_t), intent(in) :: sections
      type(bent_loads_t), intent(in) :: loads
      integer, intent(in) :: i
      !! number of the piece, that of its upper node
      real(wp) :: z
      integer :: j

      gain = 0
      associate (n => sections%beam%n, length => sections%z(i) - sections%z(i - 1))
         do j = 1, points
            z = sections%z(i - 1) + sections%share(j)*length
            gain = gain + sections%weight(j)*length*slope_from(sections%beam, loads, z, &
               dot_product(loads%q(:n), sections%slope(:, j, i)), &
               sections%above_inside(:, j, i))
         end do
      end associate
   end function moment_gain

   !> dM/dz from the slope of the axis and the integrals of the modes above [m/s2].
   pure real(wp) function slope_from(beam, loads, z, tilt, above) result(slope)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(in) :: z
      !! [m]
      real(wp), intent(in) :: tilt
      !! w' [-]
      real(wp), intent(in) :: above(:)
      !! (modes)

      slope = loads%width - (straight_part(loads%push, loads%turn, z, beam%length) &
         + dot_product(loads%across(:beam%n), above) - loads%force(1)) + tilt*(straight_part( &
         loads%pull, loads%stretch, z, beam%length) + dot_product(loads%along(:beam%n), above) &
         - loads%force(2))
   end function slope_from

   !> Find extrema of shear and moment inside a piece between two nodes that exceed those so far.
   !>
   !> A force rises inside a piece by less than 1.5 times its largest slope at three places over
   !> half the length.
   subroutine inspect_piece(sections, loads, i, found)
      type(bent_sections_t), intent(in) :: sections
      type(bent_loads_t), intent(in) :: loads
      integer, intent(in) :: i
      !! number of the piece, that of its upper node
      type(section_extremes_t), intent(inout) :: found
      real(wp), parameter :: rise = 0.75_wp
      !! largest rise over length and slope [-]
      real(wp) :: z(3), slopes(3), height, moment, ends(2)
      integer :: j

      ends = max(abs(sections%below_node(:, i)), abs(sections%above_node(:, i - 1)))
      associate (n => sections%beam%n, low => sections%z(i - 1), high => sections%z(i))
         z = [low, (low + high)/2, high]
         slopes = loads%push + loads%turn*z + [dot_product(loads%across(:n), sections%phi(:, &
            i - 1)), dot_product(loads%across(:n), sections%phi_centre(:, i)), &
            dot_product(loads%across(:n), sections%phi(:, i))]
         ends(1) = ends(1) + rise*(high - low)*maxval(abs(slopes))/sections%beam%length
         if (ends(1) > found%shear) call find_changes(sections%beam, loads, z, slopes, &
            of_shear=.true.)
         do j = 1, 2
            if (.not. ends(1) > found%shear) exit
            if (.not. slopes(j)*slopes(j + 1) < 0) cycle
            height = turning_height(sections%beam, loads, z(j:j + 1), slopes(j:j + 1), &
               of_shear=.true.)
            if (abs(shear_at(sections%beam, loads, height)) <= found%shear) cycle
            found%shear = abs(shear_at(sections%beam, loads, height))
            found%z_shear = height
         end do
         z(2) = (low + high)/2
         slopes = [slope_with(z(1), sections%tilt(:, i - 1), sections%above(:, i - 1)), &
            slope_with(z(2), sections%slope(:, centre, i), sections%above_inside(:, centre, i)), &
            slope_with(z(3), sections%tilt(:, i), sections%above(:, i))]
         ends(2) = ends(2) + rise*(high - low)*maxval(abs(slopes))
         if (.not. ends(2) > found%moment) return
         call find_changes(sections%beam, loads, z, slopes, of_shear=.false.)
         do j = 1, 2
            if (.not. slopes(j)*slopes(j + 1) < 0) cycle
            height = turning_height(sections%beam, loads, z(j:j + 1), slopes(j:j + 1), &
               of_shear=.false.)
            moment = abs(moment_below(sections, loads, i, height))
            if (moment <= found%moment) cycle
            found%moment = moment
            found%z_moment = height
         end do
      end associate

   contains

      !> dM/dz from the values of the modes.
      pure real(wp) function slope_with(z, tilt, above)
         real(wp), intent(in) :: z
         real(wp), intent(in) :: tilt(:), above(:)

         slope_with = slope_from(sections%beam, loads, z, dot_product(loads%q(:size(tilt)), tilt), &
            above)
      end function slope_with
   end subroutine inspect_piece

   !> Move the middle one of three heights to a change of sign that the three values do not show.
   !>
   !> Close to the base the deflections are small, and both roots of a parabola may lie in a piece.
   subroutine find_changes(beam, loads, z, slopes, of_shear)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(inout) :: z(3)
      !! ascending [m]
      real(wp), intent(inout) :: slopes(3)
      !! of shear or moment at these heights [m/s2]
      logical, intent(in) :: of_shear
      !! of the shear, otherwise of the moment
      real(wp) :: vertex, slope

      if (any(slopes*slopes(1) <= 0)) return
      if (abs(slopes(1) - 2*slopes(2) + slopes(3)) <= 0) return
      vertex = vertex_of_parabola(z, slopes)
      if (.not. (vertex > z(1) .and. vertex < z(3))) return
      if (of_shear) then
         slope = acceleration_across(beam, loads, vertex)
      else
         slope = moment_slope(beam, loads, vertex)
      end if
      if (slope*slopes(1) >= 0) return
      z(2) = vertex
      slopes(2) = slope
   end subroutine find_changes

   !> Moment at a height inside a piece, from that below its upper node [m2/s2].
   real(wp) function moment_below(sections, loads, i, height) result(moment)
      type(bent_sections_t), intent(in) :: sections
      type(bent_loads_t), intent(in) :: loads
      integer, intent(in) :: i
      !! number of the piece, that of its upper node
      real(wp), intent(in) :: height
      !! [m]
      real(wp) :: span
      integer :: j

      span = sections%z(i) - height
      moment = sections%below_node(2, i)
      do j = 1, points
         moment = moment - span*sections%weight(j)*moment_slope(sections%beam, loads, height &
            + sections%share(j)*span)
      end do
   end function moment_below

   !> Height inside a piece at which shear or moment is stationary [m].
   real(wp) function turning_height(beam, loads, z, slopes, of_shear) result(height)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(in) :: z(2)
      !! ends of the piece [m]
      real(wp), intent(in) :: slopes(2)
      !! slopes at both, of different sign [m/s2]
      logical, intent(in) :: of_shear
      !! of the shear, otherwise of the moment
      type(secant_t) :: search

      search = secant_between(z, slopes)
      do while (search%is_open)
         height = search%next
         if (of_shear) then
            call close_in(search, acceleration_across(beam, loads, height))
         else
            call close_in(search, moment_slope(beam, loads, height))
         end if
      end do
   end function turning_height

   !> Acceleration across the axis, -2h dV/dz [m/s2].
   pure real(wp) function acceleration_across(beam, loads, z) result(a)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(in) :: z
      integer :: k

      a = loads%push + loads%turn*z
      do k = 1, beam%n
         a = a + loads%across(k)*deflection(beam%modes(k), z/beam%length)
      end do
   end function acceleration_across

   !> Shear at a height [m/s2].
   pure real(wp) function shear_at(beam, loads, z) result(shear)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(in) :: z
      integer :: k

      shear = straight_part(loads%push, loads%turn, z, beam%length) - loads%force(1)
      do k = 1, beam%n
         shear = shear + loads%across(k)*force_above(beam%modes(k), z/beam%length)
      end do
   end function shear_at

   !> dM/dz at a height [m/s2].
   pure real(wp) function moment_slope(beam, loads, z) result(slope)
      type(beam_t), intent(in) :: beam
      type(bent_loads_t), intent(in) :: loads
      real(wp), intent(in) :: z
      real(wp) :: above(most_modes), tilt
      integer :: k

      tilt = 0
      do k = 1, beam%n
         tilt = tilt + loads%q(k)*slope_of(beam%modes(k), z/beam%length)/beam%length
         above(k) = force_above(beam%modes(k), z/beam%length)
      end do
      slope = slope_from(beam, loads, z, tilt, above(:beam%n))
   end function moment_slope

end module rwmf_model_system_bent_sections
