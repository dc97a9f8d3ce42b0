!> Section forces of the rigid wall, from the balance of the part above a section. Its loads are its
!> weight and inertia, the links to the frame, and the cable at its top. Forces at the base act
!> below every section and do not enter (docs/theory/demands.md, "Demands").
module rwmf_model_system_wall_sections
   use rwmf_core_kinds, only: wp
   use rwmf_model_elements, only: element_force, element_path, element_t, of_cable, of_restraint
   use rwmf_model_equation, only: equation_t, ground, vertical_ground
   use rwmf_model_system_reactions, only: cable_force
   implicit none
   private

   public :: links_t, section_extremes_t, link_places, find_section_extremes
   public :: find_forces_beside

   !> Forces of the links on the wall, from the lowest link to that at the roof.
   type :: links_t
      real(wp), allocatable :: place(:, :)
      !! (2, links) position from the middle of the base, along the base to the right and up the
      !! axis [m]
      real(wp), allocatable :: force(:, :)
      !! (2, links) horizontal and upward force, over m_w [m/s2]
   end type links_t

   !> Largest section forces along the height, and their positions.
   type :: section_extremes_t
      real(wp) :: shear = -1
      !! largest shear, over m_w [m/s2]
      real(wp) :: moment = -1
      !! largest moment about the axis, over m_w [m2/s2]
      real(wp) :: z_shear = 0
      !! its height above the base [m]
      real(wp) :: z_moment = 0
      !! its height above the base [m]
   end type section_extremes_t

   !> Loads on the part of the wall above a section, in the axes of the wall.
   type :: loads_t
      real(wp) :: h, b
      !! half height and half width [m]
      real(wp) :: push
      !! acceleration across the axis at the base, gravity included [m/s2]
      real(wp) :: turn
      !! theta'' [rad/s2]
      real(wp) :: sine, cosine
      !! sine and cosine of theta [-]
      real(wp) :: across
      !! force of cable and links across the axis [m/s2]
      real(wp) :: about
      !! moment of cable and links about the middle of the base [m2/s2]
   end type loads_t

contains

   !> Positions of the links on the wall. They are on the line from the pivot to the top corner of
   !> the roof link, at the heights of their floors. On a hinged wall they are on its axis.
   pure function link_places(equation, share) result(place)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: share(:)
      !! (links) height of each link over that of the wall [-]
      real(wp) :: place(2, size(share))
      !! [m]
      real(wp) :: to_corner
      !! distance along the base from the pivot to that corner [m]

      associate (p => equation%p, side => equation%state%side)
         to_corner = 0
         if (equation%geometry%sine_wall > 0) to_corner = -2*side*p%R*equation%geometry &
            %sine_lever(side)
         place(1, :) = side*p%R*equation%geometry%sine_wall + share*to_corner
         place(2, :) = 2*p%R*p%cos_alpha*share
      end associate
   end function link_places

   !> Find the largest shear and the largest bending moment along the height at an instant.
   subroutine find_section_extremes(equation, t, y, y_ddot, links, extremes)
      type(equation_t), intent(in) :: equation
      !! with a wall
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      type(links_t), intent(in) :: links
      type(section_extremes_t), intent(out) :: extremes
      type(loads_t) :: loads
      type(links_t) :: held
      !! links and elements on the wall
      real(wp) :: z(2)
      !! ends of a piece between links [m]
      real(wp) :: s(3)
      !! distances from the top at which a force may be largest inside the piece [m]
      integer :: i, j

      loads = loads_at_top(equation, t, y, y_ddot)
      call add_held_points(equation, y, links, held)
      z(1) = 2*loads%h
      do i = size(held%place, 2), 0, -1
         z(2) = z(1)
         z(1) = 0
         if (i > 0) z(1) = held%place(2, i)
         s = stationary_places(loads)
         call inspect_section(z(1))
         call inspect_section(z(2))
         do j = 1, size(s)
            if (2*loads%h - s(j) > z(1) .and. 2*loads%h - s(j) < z(2)) then
               call inspect_section(2*loads%h - s(j))
            end if
         end do
         if (i > 0) call add_link(loads, held, i)
      end do

   contains

      !> Include a section of the piece in the search.
      subroutine inspect_section(at)
         real(wp), intent(in) :: at
         real(wp) :: force(2)

         force = abs(forces_at(loads, at))
         if (force(1) > extremes%shear) then
            extremes%shear = force(1)
            extremes%z_shear = at
         end if
         if (force(2) > extremes%moment) then
            extremes%moment = force(2)
            extremes%z_moment = at
         end if
      end subroutine inspect_section
   end subroutine find_section_extremes

   !> Compute shear and bending moment just below and just above sections. They are the forces of
   !> the part below on the part above.
   subroutine find_forces_beside(equation, t, y, y_ddot, links, z, below, above)
      type(equation_t), intent(in) :: equation
      !! with a wall
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      type(links_t), intent(in) :: links
      real(wp), intent(in) :: z(:)
      !! (sections) ascending heights above the base, at most one of them at each link [m]
      real(wp), intent(out) :: below(:, :), above(:, :)
      !! (2, sections) shear across the axis, positive as u_g'' [m/s2], and clockwise moment about
      !! the axis [m2/s2], over m_w
      real(wp), parameter :: same = 1.0e-9_wp
      !! distance within which a link counts as at a section, over the height of the wall [-]
      type(loads_t) :: loads
      type(links_t) :: held
      !! links and elements on the wall
      integer :: i, j

      loads = loads_at_top(equation, t, y, y_ddot)
      call add_held_points(equation, y, links, held)
      j = size(held%place, 2)
      do i = size(z), 1, -1
         call pass_links(z(i) + 2*same*loads%h)
         above(:, i) = forces_at(loads, z(i))
         call pass_links(z(i) - 2*same*loads%h)
         below(:, i) = forces_at(loads, z(i))
      end do

   contains

      !> Add the links down to a height.
      subroutine pass_links(height)
         real(wp), intent(in) :: height

         do while (j > 0)
            if (held%place(2, j) < height) return
            call add_link(loads, held, j)
            j = j - 1
         end do
      end subroutine pass_links
   end subroutine find_forces_beside

   !> Add to the links the tendons that do not end at the top of the axis, and the restraints, in
   !> the order of their heights.
   subroutine add_held_points(equation, y, links, held)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(links_t), intent(in) :: links
      type(links_t), intent(out) :: held
      real(wp), allocatable :: all_points(:, :)
      !! (4, points) place [m] and force [m/s2]
      integer :: i, k

      allocate (all_points(4, size(links%place, 2)))
      all_points(:2, :) = links%place
      all_points(3:, :) = links%force
      if (allocated(equation%elements)) then
         do i = 1, size(equation%elements)
            associate (element => equation%elements(i), side => equation%state%side)
               if (.not. is_off_top(equation, element)) cycle
               k = count(all_points(2, :) < element%stroke%height)
               all_points = reshape([all_points(:, :k), element%offset, element%stroke%height, &
                  element%weight*element_force(element, equation%state%springs, side, side*y(1), &
                  side*y(2))*element_path(element, side, side*y(1)), all_points(:, k + 1:)], &
                  [4, size(all_points, 2) + 1])
            end associate
         end do
      end if
      held%place = all_points(:2, :)
      held%force = all_points(3:, :)
   end subroutine add_held_points

   !> True for a restraint, and for a tendon that does not end at the top of the axis.
   pure logical function is_off_top(equation, element)
      type(equation_t), intent(in) :: equation
      type(element_t), intent(in) :: element
      real(wp), parameter :: same = 1.0e-9_wp
      !! distance within which an anchor counts as at the top, over the height [-]

      is_off_top = element%group == of_restraint .or. (element%group == of_cable &
         .and. (abs(element%offset) > 0 .or. element%stroke%height < 2*(1 - same)*equation%p%R &
         *equation%p%cos_alpha))
   end function is_off_top

   !> Force of the tendons that end at the top of the axis [m/s2].
   function force_at_top(equation, theta) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: force(2)
      integer :: i

      force = cable_force(equation, theta)
      if (.not. allocated(equation%elements)) return
      associate (side => equation%state%side)
         do i = 1, size(equation%elements)
            associate (element => equation%elements(i))
               if (element%group == of_cable .and. is_off_top(equation, element)) force = force &
                  - element_force(element, equation%state%springs, side, side*theta, 0.0_wp) &
                  *element_path(element, side, side*theta)
            end associate
         end do
      end associate
   end function force_at_top

   !> Collect the loads at the top. Tendons on the axis are anchored there.
   type(loads_t) function loads_at_top(equation, t, y, y_ddot) result(loads)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      real(wp) :: g
      !! gravity including the vertical ground acceleration [m/s2]
      real(wp) :: cable(2)

      loads%h = equation%p%R*equation%p%cos_alpha
      loads%b = equation%p%R*equation%p%sin_alpha
      loads%turn = y_ddot
      loads%sine = sin(y(1))
      loads%cosine = cos(y(1))
      g = equation%p%g
      if (equation%has_vertical) g = g + vertical_ground(equation, t)
      loads%push = ground(equation, t)*loads%cosine - g*loads%sine &
         + equation%state%side*equation%p%R*equation%geometry%sine_wall*y(2)**2
      cable = force_at_top(equation, y(1))
      loads%across = loads%cosine*cable(1) - loads%sine*cable(2)
      loads%about = 2*loads%h*loads%across
   end function loads_at_top

   !> Add the force of a link to the loads above the section.
   pure subroutine add_link(loads, links, i)
      type(loads_t), intent(inout) :: loads
      type(links_t), intent(in) :: links
      integer, intent(in) :: i
      !! number of the link
      real(wp) :: across

      associate (place => links%place(:, i), force => links%force(:, i))
         across = loads%cosine*force(1) - loads%sine*force(2)
         loads%across = loads%across + across
         loads%about = loads%about + place(2)*across - place(1)*(loads%sine*force(1) &
            + loads%cosine*force(2))
      end associate
   end subroutine add_link

   !> Compute shear and moment at a height.
   pure function forces_at(loads, z) result(force)
      type(loads_t), intent(in) :: loads
      real(wp), intent(in) :: z
      real(wp) :: force(2)
      real(wp) :: s

      s = 2*loads%h - z
      associate (push => loads%push + loads%turn*z, per_length => 1/(2*loads%h))
         force(1) = per_length*s*(push + loads%turn*s/2) - loads%across
         force(2) = per_length*s*(push*s/2 + loads%turn*(s**2 + loads%b**2)/3) &
            - (loads%about - z*loads%across)
      end associate
   end function forces_at

   !> Distances from the top at which shear or moment is stationary; negative if there is none [m].
   pure function stationary_places(loads) result(s)
      type(loads_t), intent(in) :: loads
      real(wp) :: s(3)
      real(wp) :: bend, slope, rest, root

      s = -1
      if (abs(loads%turn) <= 0) then
         ! the moment is a parabola
         if (abs(loads%push) > 0) s(2) = 2*loads%h*loads%across/loads%push
         return
      end if
      s(1) = 2*loads%h + loads%push/loads%turn
      ! stationary moment, rest + slope s + bend s**2 = 0, from shear and rotational inertia of a
      ! slice
      bend = -loads%turn/2
      slope = loads%push + 2*loads%h*loads%turn
      rest = loads%turn*loads%b**2/3 - 2*loads%h*loads%across
      root = slope**2 - 4*bend*rest
      if (root < 0) return
      root = -(slope + sign(sqrt(root), slope))/2
      s(2) = root/bend
      if (abs(root) > 0) s(3) = rest/root
   end function stationary_places

end module rwmf_model_system_wall_sections
